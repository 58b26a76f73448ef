//! The settings as users see them: from this table the page builds a control for each, the command
//! line an option, and `docs/settings.md` a row. Defaults and ranges agree with [`Settings`].

use super::{BeyondPoints, BoxCell, BoxFaces, BoxMode, SolidSettings};
use crate::sampler::{Counting, GapPolicy, LawKind, Method, Pattern, Sampling, Settings, SizeMode};
use core::ops::RangeInclusive;
use serde::Serialize;

/// A setting of a run.
#[derive(Clone, Copy, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Setting {
    /// Name in [`Settings`].
    pub name: &'static str,
    /// Name for a person.
    pub label: &'static str,
    /// Explanation in one line.
    pub help: &'static str,
    /// Group in which the setting is shown.
    pub group: SettingGroup,
    /// Type of the values.
    pub kind: SettingKind,
    /// Default value.
    pub default: SettingValue,
    /// Smallest value; 0 for a choice.
    pub min: f64,
    /// Largest value that the page offers; 0 for a choice.
    pub max: f64,
    /// Largest value that is accepted.
    #[serde(skip)]
    pub accepted_max: f64,
    /// Step of a slider; on a logarithmic scale a factor minus one. 0 for a choice.
    pub step: f64,
    /// Scale of a slider.
    pub scale: SettingScale,
    /// Unit; `%` stands for a share of the diagonal of the box, which is shown times 100.
    pub unit: &'static str,
    /// Values of a choice.
    pub choices: &'static [Choice],
    /// The setting has an effect, and is shown, while all of these hold; always if the list is
    /// empty.
    pub when: &'static [Condition],
}

impl Setting {
    /// Range of the values that are accepted, for a setting that is a number.
    #[must_use]
    pub fn accepted(&self) -> RangeInclusive<f64> {
        self.min..=self.accepted_max
    }

    /// Whether the setting is a share of the diagonal of the box.
    #[must_use]
    pub fn is_share(&self) -> bool {
        self.unit == "%"
    }

    /// Whether the setting has no effect unless a condition of it holds. Relaxation steps are shown
    /// for the method of a front alone, and also matter where a front cannot be refined.
    #[must_use]
    pub fn depends_on(&self, condition: &Condition) -> bool {
        (self.name, condition.name) != ("relax_steps", "method")
    }

    /// Whether the setting has an effect only while another setting has this value.
    #[must_use]
    pub fn needs(&self, name: &str, value: &str) -> bool {
        self.when
            .iter()
            .any(|condition| condition.equal && (condition.name, condition.value) == (name, value))
    }

    /// Name of its option of the command line, without the dashes.
    #[must_use]
    pub fn option(&self) -> String {
        self.argument().replace('_', "-")
    }

    /// Name of its argument in Python; JavaScript has the same words in camel case. Passing the
    /// argument of an adaptive size, of a count or of a box also chooses that mode.
    #[must_use]
    pub fn argument(&self) -> &'static str {
        match self.name {
            "box_mode" => "box",
            "box_faces" => "closed",
            "box_cell" => "periodic",
            "sampling" => "adaptive",
            "size_mode" => "count",
            "radius_share" => "radius",
            "radius_law" => "law",
            "radius_min_share" => "radius_min",
            "radius_max_share" => "radius_max",
            "relax_steps" => "relax",
            "counting" => "exactly",
            name => name,
        }
    }
}

/// A given setting without effect, and the condition that fails. With a spacing by a function, when
/// the run `is_spaced`, grading has an effect.
#[must_use]
pub fn without_effect(
    given: &[&str],
    values: &Settings,
    solid: &SolidSettings,
    is_spaced: bool,
) -> Option<(Setting, Condition)> {
    let choices = [
        ("sampling", SettingValue::from(values.sampling)),
        ("size_mode", values.size_mode.into()),
        ("radius_law", values.radius_law.into()),
        ("pattern", values.pattern.into()),
        ("method", values.method.into()),
        ("box_faces", solid.box_faces.into()),
    ];
    let fails = |condition: &&Condition| {
        let chosen = choices.iter().find(|(name, _)| *name == condition.name);
        chosen.is_some_and(|&(_, value)| (value == SettingValue::Choice(condition.value)) != condition.equal)
    };
    let mut all = settings()
        .into_iter()
        .filter(|setting| given.contains(&setting.name) && !(is_spaced && setting.name == "grading"));
    all.find_map(|setting| {
        let mut counting = setting.when.iter().filter(|condition| setting.depends_on(condition));
        counting.find(fails).map(|&condition| (setting, condition))
    })
}

/// Group of settings that are shown together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub enum SettingGroup {
    /// Settings of the box, which act before a run.
    Box,
    /// Settings that everyone uses.
    Sampling,
    /// Settings that few users need.
    Advanced,
}

/// Type of the values of a setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum SettingKind {
    /// Numbers.
    Number,
    /// Whole numbers.
    Integer,
    /// Numbers, or texts of formulas in x, y and z.
    Formula,
    /// Texts of formulas in x, y and z, empty for none.
    Text,
    /// A few named values.
    Choice,
}

/// Scale of a slider.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum SettingScale {
    /// Equal steps add the same.
    Linear,
    /// Equal steps multiply by the same.
    Log,
}

/// The value of a setting.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(untagged)]
pub enum SettingValue {
    /// The value of a setting that is a real number.
    Number(f64),
    /// The value of a setting that is a whole number.
    Integer(u64),
    /// The value of a setting that is a choice, as in [`Choice::value`].
    Choice(&'static str),
}

impl SettingValue {
    /// Type of the setting that has such a value.
    #[must_use]
    pub fn kind(self) -> SettingKind {
        match self {
            Self::Number(_) => SettingKind::Number,
            Self::Integer(_) => SettingKind::Integer,
            Self::Choice(_) => SettingKind::Choice,
        }
    }
}

impl From<f64> for SettingValue {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<u64> for SettingValue {
    fn from(whole: u64) -> Self {
        Self::Integer(whole)
    }
}

impl From<u32> for SettingValue {
    fn from(whole: u32) -> Self {
        Self::Integer(whole.into())
    }
}

/// A value of a setting that is a choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Choice {
    /// Value, as written in JSON.
    pub value: &'static str,
    /// Name for a person.
    pub label: &'static str,
}

/// Condition on another setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Condition {
    /// Name of the other setting.
    pub name: &'static str,
    /// A choice of the other setting.
    pub value: &'static str,
    /// Whether the other setting must have that choice, or must not have it.
    pub equal: bool,
}

/// A setting that is a number, with the range that is accepted.
fn number(
    name: &'static str,
    default: impl Into<SettingValue>,
    label: &'static str,
    help: &'static str,
) -> Setting {
    let (min, max) = Settings::range(name).unwrap_or(0.0..=0.0).into_inner();
    let default = default.into();
    Setting {
        name,
        label,
        help,
        group: SettingGroup::Sampling,
        kind: default.kind(),
        default,
        min,
        max,
        accepted_max: max,
        step: 0.01,
        scale: SettingScale::Linear,
        unit: "",
        choices: &[],
        when: &[],
    }
}

/// A setting that is one of a few named values.
fn choice(
    name: &'static str,
    default: impl Into<SettingValue>,
    label: &'static str,
    help: &'static str,
    choices: &'static [Choice],
) -> Setting {
    Setting { step: 0.0, choices, ..number(name, default, label, help) }
}

const fn when(name: &'static str, value: &'static str) -> Condition {
    Condition { name, value, equal: true }
}

const CLOSED: Condition = when("box_faces", "closed");
const UNIFORM: Condition = when("sampling", "uniform");
const ADAPTIVE: Condition = when("sampling", "adaptive");
const BY_RADIUS: Condition = when("size_mode", "radius");
const BY_COUNT: Condition = when("size_mode", "count");
const BY_FRONT: Condition = when("method", "front");
const IN_HEXAGONS: Condition = when("pattern", "hexagonal");
const BY_CHORD: Condition = when("radius_law", "chord_error");
const BY_CURVATURE: Condition = Condition { equal: false, ..BY_CHORD };
const UNSPACED: Condition = when("spacing", "");

/// Declares the values of a choice: variant, value in JSON, name for a person.
macro_rules! choices {
    ($list:ident of $name:ident: $($variant:ident $value:literal $label:literal),*) => {
        const $list: &[Choice] = &[$(Choice { value: $value, label: $label }),*];

        impl From<$name> for SettingValue {
            fn from(choice: $name) -> Self {
                Self::Choice(match choice { $($name::$variant => $value),* })
            }
        }
    };
}

choices!(BOXES of BoxMode: Fit "fit" "Fit", Fixed "fixed" "Fixed");
choices!(FACES of BoxFaces: Open "open" "Open", Closed "closed" "Closed");
choices!(CELLS of BoxCell: Lone "lone" "Lone", Periodic "periodic" "Periodic");
choices!(ENDS of BeyondPoints: Cut "cut" "Cut off", Kept "kept" "Kept");
choices!(SAMPLINGS of Sampling: Uniform "uniform" "Uniform", Adaptive "adaptive" "Adaptive");
choices!(SIZES of SizeMode: Radius "radius" "Radius", Count "count" "Count");
choices!(LAWS of LawKind: ChordError "chord_error" "Chord error", MaxCurvature "max_curvature" "Largest curvature",
    SumOfCurvatures "sum_of_curvatures" "Sum of curvatures");
choices!(METHODS of Method: Front "front" "Front", Refined "refined" "Refined");
choices!(PATTERNS of Pattern: Hexagonal "hexagonal" "Hexagonal", Blue "blue" "Blue noise", Random "random" "Random");
choices!(COUNTINGS of Counting: Nearly "nearly" "Nearly", Exactly "exactly" "Exactly");
choices!(GAPS of GapPolicy: Fill "fill" "Fill", Leave "leave" "Leave");

/// Every setting, in display order.
#[must_use]
pub fn settings() -> Vec<Setting> {
    with_values(&Settings::DEFAULT)
}

/// Every setting, and the [spacing](super::SpacingText), which is a text of its own.
#[must_use]
pub(super) fn with_spacing() -> Vec<Setting> {
    let mut all = settings();
    let spacing = choice(
        "spacing",
        SettingValue::Choice(""),
        "Spacing",
        "Distance between neighbours as a formula of x, y, z and the parameters, such as 0.02 + 0.1 hypot(x, y). With a count it gives the proportions; adaptive particles keep to the smaller one.",
        &[],
    );
    for radius in all.iter_mut().filter(|setting| setting.name == "radius_share") {
        radius.when = &[UNIFORM, BY_RADIUS, UNSPACED];
    }
    let place = all.iter().position(|setting| setting.name == "radius_law").unwrap_or(all.len());
    all.insert(place, Setting { kind: SettingKind::Text, ..spacing });
    all
}

/// Every setting, with the value from `run` as its default.
pub(super) fn with_values(run: &Settings) -> Vec<Setting> {
    let log = |setting| Setting { scale: SettingScale::Log, ..setting };
    let share = |setting| Setting { unit: "%", ..log(setting) };
    let particles = |setting| Setting { unit: "particles", ..log(setting) };
    let advanced = |setting| Setting { group: SettingGroup::Advanced, ..setting };
    let of_box = |setting| Setting { group: SettingGroup::Box, ..setting };
    let thicknesses = SolidSettings::THICKNESSES;
    vec![
        of_box(choice(
            "box_mode",
            BoxMode::default(),
            "Box",
            "Fit: the box follows the surface of a formula, with 5 % to spare; a surface without end is cut. Fixed: the box stays as it is.",
            BOXES,
        )),
        of_box(choice(
            "box_faces",
            BoxFaces::default(),
            "Faces",
            "Closed: the faces of the box close what they cut. This gives the solid f ≤ 0 in the box, with sharp edges. For formulas.",
            FACES,
        )),
        Setting {
            when: &[CLOSED],
            ..of_box(choice(
                "box_cell",
                BoxCell::default(),
                "Cell",
                "Periodic: opposite faces have the same particles and triangles, up to the shift and to the last bit, along every axis on which the box is a whole number of periods wide. For closed solids.",
                CELLS,
            ))
        },
        Setting {
            min: *thicknesses.start(),
            max: *thicknesses.end(),
            accepted_max: *thicknesses.end(),
            kind: SettingKind::Formula,
            ..of_box(number(
                "thickness",
                0.0,
                "Thickness",
                "Thickness t of a shell around the surface, |f| ≤ t/2 |∇f|, which is sampled instead, in the units of x, y and z; 0 for the surface itself. A formula such as 0.1 + 0.05z makes it vary. For formulas.",
            ))
        },
        of_box(choice(
            "beyond_points",
            BeyondPoints::default(),
            "Beyond points",
            "Cut off: the surface ends at the border of its points, and bridges gaps of a few spacings. Kept: it continues. For models from points.",
            ENDS,
        )),
        choice(
            "sampling",
            run.sampling,
            "Sampling",
            "One size everywhere, or sizes that follow the curvature: small particles where the surface bends, large ones where it is flat.",
            SAMPLINGS,
        ),
        choice(
            "size_mode",
            run.size_mode,
            "Size by",
            "Radius: you set the size of the particles, or for adaptive sampling the law of their sizes. Count: you set their number.",
            SIZES,
        ),
        Setting {
            when: &[UNIFORM, BY_RADIUS],
            ..share(number(
                "radius_share",
                run.radius_share,
                "Radius",
                "Repulsion radius r as a share of the box diagonal; neighbours sit 2r apart. The paper shows 2 % and 0.6 %.",
            ))
        },
        Setting {
            when: &[BY_COUNT],
            ..particles(number(
                "count",
                run.count,
                "Count",
                "Target count, met to within 3 %. Adaptive sampling scales all radii by one factor.",
            ))
        },
        Setting {
            when: &[BY_COUNT, BY_FRONT],
            ..advanced(choice(
                "counting",
                run.counting,
                "Count met",
                "Nearly: to within 3 %. Exactly: before the relaxation the most crowded particles of the front are removed, or some are added in its largest holes. Blue noise and random points always have the wanted count.",
                COUNTINGS,
            ))
        },
        Setting {
            when: &[ADAPTIVE],
            ..choice(
                "radius_law",
                run.radius_law,
                "Radius law",
                "How the radius follows from the principal curvatures: by the chord error, by the larger one of them, or by their sum, as in the paper, which vanishes on saddles.",
                LAWS,
            )
        },
        Setting {
            when: &[ADAPTIVE, BY_CHORD],
            ..share(number(
                "chord_error",
                run.chord_error,
                "Chord error",
                "Largest gap between the surface and a triangle of neighbours, as a share of the box diagonal.",
            ))
        },
        Setting {
            unit: "× 1/κ",
            when: &[ADAPTIVE, BY_CURVATURE],
            ..log(number(
                "curvature_scale",
                run.curvature_scale,
                "Curvature scale",
                "Radius of a particle over the radius of curvature 1/κ of the surface there: about half the angle between the normals of neighbours, in radians.",
            ))
        },
        Setting {
            when: &[ADAPTIVE],
            ..advanced(share(number(
                "radius_min_share",
                run.radius_min_share,
                "Smallest radius",
                "Radius of the smallest particles, at least, as a share of the box diagonal.",
            )))
        },
        Setting {
            when: &[ADAPTIVE],
            ..advanced(share(number(
                "radius_max_share",
                run.radius_max_share,
                "Largest radius",
                "Radius of the largest particles, at most, as a share of the box diagonal.",
            )))
        },
        Setting {
            when: &[ADAPTIVE],
            ..advanced(number(
                "grading",
                run.grading,
                "Grading",
                "How fast the radius may change along the surface: a slope L, a number without unit. The radii of neighbours differ by a factor of at most (1 + L)/(1 − L), which is 1.5 for L = 0.2.",
            ))
        },
        Setting {
            // On a slider up to the largest accepted value, the paper's ten steps would be at its
            // very beginning.
            max: 100.0,
            step: 1.0,
            unit: "steps",
            // Refined particles are in order already, and other patterns would not stay.
            when: &[BY_FRONT, IN_HEXAGONS],
            ..number(
                "relax_steps",
                run.relax_steps,
                "Relaxation",
                "Number of relaxation steps after the front, in which particles push each other apart. The paper takes ten.",
            )
        },
        advanced(choice(
            "method",
            run.method,
            "Method",
            "Front: a front and its relaxation, as in the paper. Refined: a coarse front is brought into order and its edges are halved, which is more even and takes longer.",
            METHODS,
        )),
        Setting {
            when: &[BY_FRONT],
            ..advanced(choice(
                "pattern",
                run.pattern,
                "Pattern",
                "Hexagonal, as the front grows. Blue noise: a Poisson-disk pattern without rows, no pair nearer than 2r and no hole wider. Random: independent points, even by area. These two are not relaxed.",
                PATTERNS,
            ))
        },
        Setting {
            unit: "× 2r",
            ..advanced(number(
                "match_tolerance",
                run.match_tolerance,
                "Match tolerance",
                "Distance, in units of 2r, within which a child is matched with an existing particle instead of being added. Smaller: more and closer particles where fronts meet. Larger: wider gaps.",
            ))
        },
        advanced(choice(
            "gaps",
            run.gaps,
            "Gaps",
            "Fill: where fronts meet, gaps that are wide enough for a particle get one. Leave: they stay for the relaxation to close, as in the paper.",
            GAPS,
        )),
        Setting {
            // Six digits, short enough to copy by hand.
            max: 999_999.0,
            step: 1.0,
            ..advanced(number(
                "seed",
                run.seed,
                "Seed",
                "A whole number that chooses the point on the surface where the front begins.",
            ))
        },
        advanced(particles(number(
            "max_particles",
            run.max_particles,
            "Limit",
            "Largest number of particles: the run stops when it has placed as many.",
        ))),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Map, Value as Json, json};

    #[test]
    fn every_setting_of_a_run_is_shown_with_the_value_that_it_has_as_text() {
        let mut text: Map<String, Json> = match json!(Settings::DEFAULT) {
            Json::Object(text) => text,
            other => panic!("settings are an object, not {other}"),
        };
        let Json::Object(of_box) = json!(SolidSettings::default()) else { panic!("settings are an object") };
        text.extend(of_box);
        let shown: Map<String, Json> =
            settings().iter().map(|setting| (setting.name.to_owned(), json!(setting.default))).collect();
        assert_eq!(shown, text);
    }

    #[test]
    fn every_value_of_a_choice_is_read_as_itself() {
        for setting in settings().iter().filter(|setting| setting.group != SettingGroup::Box) {
            for choice in setting.choices {
                let settings: Settings =
                    serde_json::from_value(json!({ setting.name: choice.value })).expect("settings");
                assert_eq!(json!(settings)[setting.name], choice.value, "{}", setting.name);
            }
        }
    }

    #[test]
    fn numbers_have_a_range_and_a_step() {
        for setting in settings().iter().filter(|setting| setting.kind != SettingKind::Choice) {
            assert!(
                setting.min < setting.max && setting.max <= setting.accepted_max && setting.step > 0.0,
                "{}",
                setting.name
            );
        }
    }
}
