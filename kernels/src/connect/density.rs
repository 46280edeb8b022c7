//! Densities of whole paths, whatever their size.

/// A density, `mantissa * e^exponent`: a plain product, except that its range does not end where that of f64 does.
///
/// It would be left soon: with a mean free path of a kilometre every vertex brings a factor of about 1e-9 per cubic
/// metre, and the product of 36 of them is no longer a number. So is `exp(-mu_t s)` past 745 mean free paths, although
/// the quotient of two such densities is of the order of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Density {
    mantissa: f64,
    exponent: f64,
}

impl Density {
    /// The density of what is never made.
    pub const ZERO: Self = Self { mantissa: 0.0, exponent: 0.0 };

    /// A density of one factor.
    pub fn new(factor: f64) -> Self {
        Self { mantissa: factor, exponent: 0.0 }
    }

    /// Multiplied by `factor`, >= 0.
    pub fn times(self, factor: f64) -> Self {
        let product = Self { mantissa: self.mantissa * factor, ..self };
        if product.mantissa == 0.0 || (1e-100..1e100).contains(&product.mantissa) {
            return product;
        }
        Self { mantissa: 1.0, exponent: product.exponent + product.mantissa.ln() }
    }

    /// Multiplied by `e^exponent`.
    pub fn times_exp(self, exponent: f64) -> Self {
        Self { exponent: self.exponent + exponent, ..self }
    }

    /// The product of two densities.
    pub fn product(self, other: Self) -> Self {
        self.times(other.mantissa).times_exp(other.exponent)
    }

    /// The quotient of two densities.
    pub fn over(self, other: Self) -> f64 {
        if self.mantissa == 0.0 {
            return 0.0;
        }
        self.mantissa / other.mantissa * (self.exponent - other.exponent).exp()
    }

    /// Its natural logarithm.
    pub fn ln(self) -> f64 {
        self.mantissa.ln() + self.exponent
    }

    /// Whether it is that of what is never made.
    pub fn is_zero(self) -> bool {
        self.mantissa == 0.0
    }

    /// The density as a number, as far as it is one.
    pub fn value(self) -> f64 {
        self.over(Self::new(1.0))
    }
}
