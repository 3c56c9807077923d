//! A polynomial of fourth degree through some samples in a row, which need not be evenly spaced, by least squares.
//!
//! `q(u) = sum c_j p_j(u)`, `p_{j+1} = (u - alpha_j) p_j - beta_j p_{j-1}`, orthogonal over the samples (Forsythe 1957), so that
//! five samples are met exactly, more are smoothed, and the deviation of `q` under white noise of deviation one is
//! `sqrt(sum p_j^2 / |p_j|^2)`.
//!
//! `u` time from the middle sample as a share of the window's half width · `c_j` coefficients · `|p_j|^2` sum over the samples

/// Terms of the polynomial.
const TERMS: usize = 5;

/// Most steps of Newton's iteration; three are the rule.
const STEPS: usize = 12;
/// Change of `u` at which it has converged.
const CONVERGED: f64 = 1e-13;

/// The polynomial.
#[derive(Debug, Clone, Copy)]
pub struct LocalFit {
    center: f64,
    half_width: f64,
    first: f64,
    alpha: [f64; TERMS],
    beta: [f64; TERMS],
    norm: [f64; TERMS],
    coefficients: [f64; TERMS],
    terms: usize,
}

/// What the polynomial says of an instant.
#[derive(Debug, Clone, Copy)]
pub struct Instant {
    /// When, in s.
    pub time: f64,
    /// Value there.
    pub value: f64,
    /// Its change in a second.
    pub slope: f64,
    /// Standard deviation of the value under white noise of deviation one.
    pub noise: f64,
    /// Size of the last term: what a polynomial of a degree less would leave out.
    pub last_term: f64,
}

impl LocalFit {
    /// The polynomial through at least two samples; of a lower degree through fewer than five.
    pub fn new(time: &[f64], value: &[f64]) -> Self {
        let count = time.len().min(value.len());
        let (begin, end) = (time[0], time[count - 1]);
        let mut fit = Self {
            center: f64::midpoint(begin, end),
            half_width: (end - begin) * 0.5,
            first: value[0],
            alpha: [0.0; TERMS],
            beta: [0.0; TERMS],
            norm: [1.0; TERMS],
            coefficients: [0.0; TERMS],
            terms: count.min(TERMS),
        };
        for j in 0..fit.terms {
            let (mut norm, mut moment, mut projection) = (0.0, 0.0, 0.0);
            for (&t, &x) in time.iter().zip(value) {
                let u = (t - fit.center) / fit.half_width;
                let p = fit.polynomial(j, u);
                norm += p * p;
                moment += u * p * p;
                projection += p * (x - fit.first);
            }
            fit.norm[j] = norm;
            fit.alpha[j] = moment / norm;
            fit.beta[j] = if j == 0 { 0.0 } else { norm / fit.norm[j - 1] };
            fit.coefficients[j] = projection / norm;
        }
        fit
    }

    fn polynomial(&self, j: usize, u: f64) -> f64 {
        let (mut before, mut p) = (0.0, 1.0);
        for i in 0..j {
            (before, p) = (p, (u - self.alpha[i]) * p - self.beta[i] * before);
        }
        p
    }

    /// Value less the first sample, first and second derivative by `u`.
    fn derivatives(&self, u: f64) -> [f64; 3] {
        let (mut before, mut p) = ([0.0; 3], [1.0, 0.0, 0.0]);
        let mut sum = [0.0; 3];
        for j in 0..self.terms {
            for (sum, p) in sum.iter_mut().zip(p) {
                *sum += self.coefficients[j] * p;
            }
            let (off, beta) = (u - self.alpha[j], self.beta[j]);
            let next = [
                off * p[0] - beta * before[0],
                off * p[1] + p[0] - beta * before[1],
                off * p[2] + 2.0 * p[1] - beta * before[2],
            ];
            (before, p) = (p, next);
        }
        sum
    }

    /// What it says of `u`.
    fn instant(&self, u: f64) -> Instant {
        let [value, slope, _] = self.derivatives(u);
        let squares = (0..self.terms).map(|j| self.polynomial(j, u).powi(2) / self.norm[j]);
        let last = self.terms - 1;
        Instant {
            time: self.center + u * self.half_width,
            value: self.first + value,
            slope: slope / self.half_width,
            noise: squares.sum::<f64>().sqrt(),
            last_term: (self.coefficients[last] * self.polynomial(last, u)).abs(),
        }
    }

    /// When it passes `level`, sought from `near`; none if it does not within the window or one half width around it.
    pub fn crossing(&self, level: f64, near: f64) -> Option<Instant> {
        let level = level - self.first;
        self.newton(near, |[value, slope, _]| (value - level) / slope)
    }

    /// Its extremum, sought from `near`; none as for a crossing.
    pub fn extremum(&self, near: f64) -> Option<Instant> {
        self.newton(near, |[_, slope, curvature]| slope / curvature)
    }

    fn newton(&self, near: f64, step: impl Fn([f64; 3]) -> f64) -> Option<Instant> {
        let mut u = (near - self.center) / self.half_width;
        for _ in 0..STEPS {
            let change = step(self.derivatives(u));
            u -= change;
            if u.is_nan() || u.abs() > 2.0 {
                return None;
            }
            if change.abs() < CONVERGED {
                break;
            }
        }
        Some(self.instant(u))
    }
}
