//! How what a caller asks for is read from JSON.

use super::{FieldRequest, PointsRequest};
use crate::field::formula::Parameter;
use crate::field::model::{ModelInfo, NormalSource};
use crate::json::{Error, Read, Value};
use crate::math::Bounds;
use crate::sampler::{GapPolicy, LawKind, Placement, Sampling, Settings, SizeMode};

/// Reads a structure by its fields; those that are missing are as in the default one, if there is one.
macro_rules! fields {
    ($type:ident or $default:expr => $($field:ident),*) => {
        impl Read for $type {
            fn read(value: Value) -> Result<Self, Error> {
                let mut fields = value.fields()?;
                let default: Option<Self> = $default;
                Ok(Self { $($field: fields.field(stringify!($field), default.as_ref().map(|d| d.$field.clone()))?),* })
            }
        }
    };
}

/// Reads a choice by the names of its values, which are those that it is written with.
macro_rules! choices {
    ($type:ident => $($name:literal $value:ident),*) => {
        impl Read for $type {
            fn read(value: Value) -> Result<Self, Error> {
                match &value {
                    Value::Text(text) => match text.as_str() {
                        $($name => Ok(Self::$value),)*
                        _ => Err(value.refused(concat!("one of", $(" ", $name),*))),
                    },
                    other => Err(other.refused("a text")),
                }
            }
        }
    };
}

fields!(Bounds or None => min, max);
fields!(Parameter or None => name, label, value, min, max, step);
fields!(ModelInfo or None => name, credit, points, centres, condition, residual_mean, residual_max, normals, warnings);
fields!(PointsRequest or None => info, bounds);
fields!(FieldRequest or Some(Self::default()) => surface, formula, parameters, declare, bounds);
fields!(Settings or Some(Self::default()) => sampling, size_mode, radius_share, radius_law, chord_error, curvature_scale,
    radius_min_share, radius_max_share, grading, placement, count, relax_steps, match_tolerance, gaps, seed, max_particles);

choices!(NormalSource => "given" Given, "from_mesh" FromMesh, "estimated" Estimated);
choices!(SizeMode => "radius" Radius, "count" Count);
choices!(GapPolicy => "fill" Fill, "leave" Leave);
choices!(Sampling => "uniform" Uniform, "adaptive" Adaptive);
choices!(LawKind => "chord_error" ChordError, "max_curvature" MaxCurvature, "sum_of_curvatures" SumOfCurvatures);
choices!(Placement => "direct" Direct, "faithful" Faithful);
