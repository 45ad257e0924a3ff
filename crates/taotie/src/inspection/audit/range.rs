//! The allowed range of a value.

use super::words::number;
use serde::de::{Deserialize, Deserializer, Error};

/// The minimum and maximum value allowed; `None` for no limit.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Deserialize)]
#[serde(try_from = "Limits")]
pub(super) struct AuditRange {
    pub minimum: Option<f64>,
    pub maximum: Option<f64>,
}

/// The limits as in the schema.
#[derive(Default, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Limits {
    #[serde(deserialize_with = "limit")]
    minimum: Option<f64>,
    #[serde(deserialize_with = "limit")]
    maximum: Option<f64>,
}

/// Reads a limit, which is at least 0; −1 means none.
pub(super) fn limit<'de, D: Deserializer<'de>>(from: D) -> Result<Option<f64>, D::Error> {
    match Option::<f64>::deserialize(from)? {
        Some(-1.0) | None => Ok(None),
        Some(limit) if limit >= 0.0 => Ok(Some(limit)),
        Some(limit) => {
            Err(D::Error::custom(format!("invalid limit {limit}: use 0 or more, or -1 for no limit")))
        }
    }
}

impl TryFrom<Limits> for AuditRange {
    type Error = String;

    fn try_from(Limits { minimum, maximum }: Limits) -> Result<Self, String> {
        match (minimum, maximum) {
            (Some(low), Some(high)) if low > high => {
                Err(format!("the minimum {low} is above the maximum {high}: no model can pass"))
            }
            _ => Ok(Self { minimum, maximum }),
        }
    }
}

impl AuditRange {
    /// Returns the range with an upper limit only.
    pub fn at_most(maximum: Option<f64>) -> Self {
        Self { minimum: None, maximum }
    }

    /// Returns the range with a lower limit only.
    pub fn at_least(minimum: Option<f64>) -> Self {
        Self { minimum, maximum: None }
    }

    /// Returns true if there is a limit.
    pub fn is_limited(&self) -> bool {
        self.minimum.is_some() || self.maximum.is_some()
    }

    /// Returns true if a value is within the limits.
    pub fn allows(&self, value: f64) -> bool {
        self.minimum.is_none_or(|least| value >= least) && self.maximum.is_none_or(|most| value <= most)
    }

    /// Returns the limits in words, such as `at least 1 and at most 5`; empty if there are none.
    pub fn words(&self) -> String {
        let least = self.minimum.map(|least| format!("at least {}", number(least)));
        let most = self.maximum.map(|most| format!("at most {}", number(most)));
        least.into_iter().chain(most).collect::<Vec<_>>().join(" and ")
    }
}
