//! What is known of a setting beside its value: from this the page builds a control, the command line an option, and the README
//! a row.

use core::ops::RangeInclusive;
use serde::Serialize;

/// A setting of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Setting {
    /// Name in [`Settings`](super::Settings).
    pub name: &'static str,
    /// Name for a person.
    pub label: &'static str,
    /// One line of explanation.
    pub help: &'static str,
    /// Group it is shown in.
    pub group: Group,
    /// What its values are.
    pub kind: Kind,
    /// Default value.
    pub default: Value,
    /// Smallest value; 0 for a choice.
    pub min: f64,
    /// Largest value that the page offers; 0 for a choice.
    pub max: f64,
    /// Largest value that is accepted, where that is another one.
    #[serde(skip)]
    pub accepted_max: Option<f64>,
    /// Step of a slider; on a logarithmic scale a factor minus one. 0 for a choice.
    pub step: f64,
    /// How values are spread over a slider.
    pub scale: Scale,
    /// Unit; `%` stands for a share of the diagonal of the box, which is shown times 100.
    pub unit: &'static str,
    /// Values of a choice.
    pub choices: &'static [Choice],
    /// The setting has an effect, and is shown, while all of these hold; always if there is none.
    pub when: &'static [Condition],
    /// Option of the command line, where its name is another one. The options of the first two choices, which kind of sampling
    /// and which measure of the size, choose by being there.
    #[serde(skip)]
    pub option: Option<&'static str>,
}

impl Setting {
    /// What most settings have in common.
    pub(super) const COMMON: Self = Self {
        name: "",
        label: "",
        help: "",
        group: Group::Sampling,
        kind: Kind::Choice,
        default: Value::Integer(0),
        min: 0.0,
        max: 0.0,
        accepted_max: None,
        step: 0.0,
        scale: Scale::Linear,
        unit: "",
        choices: &[],
        when: &[],
        option: None,
    };

    /// The values of a number that are accepted.
    #[must_use]
    pub fn accepted(&self) -> RangeInclusive<f64> {
        self.min..=self.accepted_max.unwrap_or(self.max)
    }

    /// Whether it is a share of the diagonal of the box.
    #[must_use]
    pub fn is_share(&self) -> bool {
        self.unit == "%"
    }

    /// Whether it has an effect only while another setting has this value.
    #[must_use]
    pub fn needs(&self, name: &str, value: &str) -> bool {
        self.when
            .iter()
            .any(|condition| condition.equal && (condition.name, condition.value) == (name, value))
    }

    /// Name of its option of the command line, without the dashes.
    #[must_use]
    pub fn option(&self) -> String {
        self.option.map_or_else(|| self.name.replace('_', "-"), str::to_owned)
    }
}

/// Where a setting is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub enum Group {
    /// With what everyone uses.
    Sampling,
    /// With what few need.
    Advanced,
}

/// What the values of a setting are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Numbers.
    Number,
    /// Whole numbers.
    Integer,
    /// A few named values.
    Choice,
}

/// How values are spread over a slider.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Scale {
    /// Equal steps add the same.
    Linear,
    /// Equal steps multiply by the same.
    Log,
}

/// The value of a setting.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(untagged)]
pub enum Value {
    /// Of a number.
    Number(f64),
    /// Of a whole number.
    Integer(u64),
    /// Of a choice: [`Choice::value`].
    Choice(&'static str),
}

impl Value {
    /// What kind of setting it is a value of.
    #[must_use]
    pub fn kind(self) -> Kind {
        match self {
            Self::Number(_) => Kind::Number,
            Self::Integer(_) => Kind::Integer,
            Self::Choice(_) => Kind::Choice,
        }
    }

    /// The value of a number, whole or not.
    #[must_use]
    pub fn as_number(self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(number),
            Self::Integer(whole) => Some(whole as f64),
            Self::Choice(_) => None,
        }
    }
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<u64> for Value {
    fn from(whole: u64) -> Self {
        Self::Integer(whole)
    }
}

impl From<u32> for Value {
    fn from(whole: u32) -> Self {
        Self::Integer(whole.into())
    }
}

/// One value of a choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Choice {
    /// Value, as it stands in JSON.
    pub value: &'static str,
    /// Name for a person.
    pub label: &'static str,
}

/// What has to hold of another setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Condition {
    /// Name of the other setting.
    pub name: &'static str,
    /// One of its choices.
    pub value: &'static str,
    /// Whether it has that value then, or another one.
    pub equal: bool,
}

/// Makes an enumeration of the values of a choice: variant, value in JSON, name for a person.
macro_rules! choices {
    ($(#[$doc:meta])* $name:ident { $($(#[$variant_doc:meta])* $variant:ident $value:literal $label:literal,)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
        pub enum $name {
            $($(#[$variant_doc])* #[serde(rename = $value)] $variant,)*
        }

        impl $name {
            /// Every value.
            pub const CHOICES: &[Choice] = &[$(Choice { value: $value, label: $label }),*];
        }

        impl From<$name> for Value {
            fn from(choice: $name) -> Self {
                Self::Choice(match choice { $($name::$variant => $value),* })
            }
        }
    };
}
pub(super) use choices;
