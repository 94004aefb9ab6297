//! Integration tests in one binary: linking dozens of them takes longer than running them.

mod clearance;
mod closing;
mod crossings;
mod drives;
mod fitting;
mod layouts;
mod nearest_is_nearest;
mod parry;
mod polygon_hull;
mod profiles;
mod route;
mod shapes;
mod taut_polygon;
mod tooth_forms;
mod validation_polygon_action;
