//! A recorded run as one page: the drive moves in a browser, without a server and without a network.
//!
//! ```text
//! recorded run ──film──► Film ──page──► HTML with figure, quantised frames and the program that shows them
//! ```
//!
//! The [`Animation`] is all that the page shows; it says nothing of forces or laws. [`page`] quantises it, packs it
//! and writes it into the page, whose HTML, style and programs lie in the folder `page` of this crate.

mod animation;
mod last_frames;
mod page;
mod picture;
mod recorded;
mod stream;

pub use animation::{Animation, Body, Chain, Contact, Curve, Frames, Outline, PageTexts};
pub use last_frames::LastFrames;
pub use page::{PICTURE, STAGE, STYLE, page};
pub use picture::Picture;
pub use recorded::{AnimationError, MOST_FRAMES, Selection, film};
