//! Butcher tableaux as constants, their consistency asserted at compile time.

/// An explicit Runge–Kutta method.
///
/// ```text
/// kᵢ = f(t + cᵢ h, y + h Σⱼ aᵢⱼ kⱼ),   y⁺ = y + h Σ bᵢ kᵢ
/// ```
///
/// The first stage is the evaluation at the end of the step before. The evaluation at the end of this
/// step is made in any case, for the system to judge; the error estimate may use it.
#[derive(Debug)]
pub(crate) struct Tableau {
    /// Order of consistency.
    pub(crate) order: u32,
    /// Instants cᵢ of the stages.
    pub(crate) c: &'static [f64],
    /// Rows aᵢⱼ of the stages, i > j.
    pub(crate) a: &'static [&'static [f64]],
    /// Weights bᵢ of the result.
    pub(crate) b: &'static [f64],
    /// Weights of the error estimate, of the stages and of the evaluation at the end; empty without one.
    pub(crate) error: &'static [f64],
}

/// The classical method of fourth order.
///
/// # Source
/// W. Kutta, *Z. Math. Phys.* **46**, 1901, 435–453.
pub(crate) static RK4: Tableau = Tableau {
    order: 4,
    c: &[0.0, 0.5, 0.5, 1.0],
    a: &[&[], &[0.5], &[0.0, 0.5], &[0.0, 0.0, 1.0]],
    b: &[1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0],
    error: &[],
};

/// The pair 5(4) of Dormand and Prince.
///
/// # Source
/// J. R. Dormand and P. J. Prince, *J. Comput. Appl. Math.* **6**, 1980, 19–26,
/// <https://doi.org/10.1016/0771-050X(80)90013-3>.
pub(crate) static DORMAND_PRINCE: Tableau = Tableau {
    order: 5,
    c: &[0.0, 1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0],
    a: &[
        &[],
        &[1.0 / 5.0],
        &[3.0 / 40.0, 9.0 / 40.0],
        &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
        &[
            19372.0 / 6561.0,
            -25360.0 / 2187.0,
            64448.0 / 6561.0,
            -212.0 / 729.0,
        ],
        &[
            9017.0 / 3168.0,
            -355.0 / 33.0,
            46732.0 / 5247.0,
            49.0 / 176.0,
            -5103.0 / 18656.0,
        ],
    ],
    b: &[
        35.0 / 384.0,
        0.0,
        500.0 / 1113.0,
        125.0 / 192.0,
        -2187.0 / 6784.0,
        11.0 / 84.0,
    ],
    error: &[
        71.0 / 57600.0,
        0.0,
        -71.0 / 16695.0,
        71.0 / 1920.0,
        -17253.0 / 339_200.0,
        22.0 / 525.0,
        -1.0 / 40.0,
    ],
};

const _: () = check(&RK4);
const _: () = check(&DORMAND_PRINCE);

/// Asserts shapes, row sums, quadrature conditions up to the order, and two conditions on the coupling of stages.
const fn check(t: &Tableau) {
    let stages = t.b.len();
    assert!(t.c.len() == stages && t.a.len() == stages);
    let mut coupling = 0.0; // Σ bᵢ aᵢⱼ cⱼ
    let mut i = 0;
    while i < stages {
        assert!(t.a[i].len() == i || (i == 0 && t.a[0].is_empty()));
        let (mut row, mut inner) = (0.0, 0.0);
        let mut j = 0;
        while j < i {
            row += t.a[i][j];
            inner += t.a[i][j] * t.c[j];
            j += 1;
        }
        assert!((row - t.c[i]).abs() < 1e-14, "Σⱼ aᵢⱼ = cᵢ");
        coupling += t.b[i] * inner;
        i += 1;
    }
    assert!(
        t.order < 3 || (coupling - 1.0 / 6.0).abs() < 1e-14,
        "Σ bᵢ aᵢⱼ cⱼ = 1/6"
    );

    let mut power = 1;
    while power <= t.order {
        assert!(
            (moment(t.b, t.c, power) - 1.0 / power as f64).abs() < 1e-14,
            "Σ bᵢ cᵢᵏ⁻¹ = 1/k"
        );
        power += 1;
    }
    if !t.error.is_empty() {
        assert!(t.error.len() == stages + 1);
        let mut power = 1;
        while power < t.order {
            let end = t.error[stages]; // its instant is 1
            assert!(
                (moment(t.error, t.c, power) + end).abs() < 1e-14,
                "Σ eᵢ cᵢᵏ⁻¹ = 0"
            );
            power += 1;
        }
    }
}

/// Σ wᵢ cᵢᵏ⁻¹ over the stages.
const fn moment(weights: &[f64], c: &[f64], k: u32) -> f64 {
    let mut sum = 0.0;
    let mut i = 0;
    while i < c.len() {
        let mut term = weights[i];
        let mut factor = 1;
        while factor < k {
            term *= c[i];
            factor += 1;
        }
        sum += term;
        i += 1;
    }
    sum
}
