//! Polynomials of four variables as sums of monomials, with first and second derivatives.

/// Variables of a monomial.
pub(super) const VARIABLES: usize = 4;

/// The highest power of a variable.
const HIGHEST_POWER: usize = 8;

/// The value of a monomial and its first derivatives by the four variables.
pub(super) type Row = [f64; 1 + VARIABLES];

/// Second derivatives by two variables, a symmetric matrix.
pub(super) type Hessian = [[f64; VARIABLES]; VARIABLES];

/// The monomials of a family of polynomials.
#[derive(Clone, Debug)]
pub(super) struct Basis {
    exponents: Vec<[usize; VARIABLES]>,
}

/// Powers of a variable and their first two derivatives.
#[derive(Clone, Copy)]
struct Powers {
    value: [f64; HIGHEST_POWER + 1],
    first: [f64; HIGHEST_POWER + 1],
    second: [f64; HIGHEST_POWER + 1],
}

impl Powers {
    fn new(x: f64) -> Self {
        let mut powers = Self { value: [1.0; 9], first: [0.0; 9], second: [0.0; 9] };
        for k in 1..=HIGHEST_POWER {
            powers.value[k] = powers.value[k - 1] * x;
            powers.first[k] = k as f64 * powers.value[k - 1];
            powers.second[k] = k as f64 * powers.first[k - 1];
        }
        powers
    }

    /// The power with this exponent and its first two derivatives.
    fn at(&self, exponent: usize) -> [f64; 3] {
        [self.value[exponent], self.first[exponent], self.second[exponent]]
    }
}

impl Basis {
    /// The monomials with these exponents; `None` if one is higher than 8.
    pub fn new(exponents: Vec<[usize; VARIABLES]>) -> Option<Self> {
        exponents.iter().flatten().all(|&exponent| exponent <= HIGHEST_POWER).then_some(Self { exponents })
    }

    /// All monomials of exactly this degree, in the lexical order of their exponents.
    pub fn homogeneous(degree: usize) -> Option<Self> {
        let mut exponents = Vec::new();
        for a in 0..=degree {
            for b in 0..=degree - a {
                exponents.extend((0..=degree - a - b).map(|c| [a, b, c, degree - a - b - c]));
            }
        }
        Self::new(exponents)
    }

    /// The number of monomials.
    pub fn len(&self) -> usize {
        self.exponents.len()
    }

    /// Values and first derivatives of all monomials at a point.
    pub fn rows(&self, x: &[f64; VARIABLES]) -> Vec<Row> {
        let [p, q, r, s] = x.map(Powers::new);
        let row = |&[a, b, c, d]: &[usize; VARIABLES]| {
            let (front, back) = (p.value[a] * q.value[b], r.value[c] * s.value[d]);
            [
                front * back,
                p.first[a] * q.value[b] * back,
                p.value[a] * q.first[b] * back,
                front * r.first[c] * s.value[d],
                front * r.value[c] * s.first[d],
            ]
        };
        self.exponents.iter().map(row).collect()
    }

    /// Second derivatives of all monomials at a point.
    pub fn hessians(&self, x: &[f64; VARIABLES]) -> Vec<Hessian> {
        let [p, q, r, s] = x.map(Powers::new);
        let hessian = |&[a, b, c, d]: &[usize; VARIABLES]| {
            let (p, q, r, s) = (p.at(a), q.at(b), r.at(c), s.at(d));
            let (front, back) = (p[0] * q[0], r[0] * s[0]);
            let (front_by_0, front_by_1) = (p[1] * q[0], p[0] * q[1]);
            let (back_by_2, back_by_3) = (r[1] * s[0], r[0] * s[1]);
            let (h01, h23) = (p[1] * q[1] * back, front * r[1] * s[1]);
            let (h02, h03) = (front_by_0 * back_by_2, front_by_0 * back_by_3);
            let (h12, h13) = (front_by_1 * back_by_2, front_by_1 * back_by_3);
            [
                [p[2] * q[0] * back, h01, h02, h03],
                [h01, p[0] * q[2] * back, h12, h13],
                [h02, h12, front * r[2] * s[0], h23],
                [h03, h13, h23, front * r[0] * s[2]],
            ]
        };
        self.exponents.iter().map(hessian).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_equal_central_differences() {
        let basis = Basis::homogeneous(8).unwrap();
        assert_eq!(basis.len(), 165);
        let (x, step) = ([0.8, -0.3, 0.4, 0.33], 1e-5);
        let (rows, hessians) = (basis.rows(&x), basis.hessians(&x));
        for variable in 0..VARIABLES {
            let moved = |by: f64| {
                let mut x = x;
                x[variable] += by;
                basis.rows(&x)
            };
            let (back, forth) = (moved(-step), moved(step));
            for k in 0..basis.len() {
                let slope = |part: usize| (forth[k][part] - back[k][part]) / (2.0 * step);
                // Third derivatives are below 400: an error of 1e-8.
                assert!((rows[k][1 + variable] - slope(0)).abs() < 1e-8);
                for (other, row) in hessians[k].iter().enumerate() {
                    assert!((row[variable] - slope(1 + other)).abs() < 1e-7);
                }
            }
        }
    }

    #[test]
    fn too_high_a_power_is_refused() {
        assert!(Basis::new(vec![[0, 9, 0, 0]]).is_none());
        assert!(Basis::homogeneous(9).is_none());
    }
}
