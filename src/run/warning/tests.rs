use super::*;

/// Longest first sentence, in letters: three lines of the page's report.
const FIRST_SENTENCE: usize = 110;

#[test]
fn the_first_sentence_is_short_and_names_no_part_of_the_method() {
    let (position, length) = ([-1.0 / 3.0, 1.0e-4, 12.5], 0.01);
    let unproven = |doubt| Warning::Unproven { doubt, length };
    let open = |edges, search| Warning::Open {
        edges,
        points: 34,
        position,
        length,
        search,
        is_undefined: edges == 7,
    };
    let unsampled = Unsampled { position, reach: 0.1, goes_on: true };
    let without = |is_unresolved| Warning::WithoutParticle {
        components: vec![unsampled; NAMED + 1],
        length,
        is_unresolved,
    };
    let warnings = [
        Warning::Limit { predicted: 12_345_678, limit: 1_000_000 },
        Warning::Touches,
        Warning::Bare { position, length },
        Warning::Beyond { bounds: Bounds::cube(1.0 / 3.0) },
        Warning::SampledAs { equation: "x = 0".to_owned() },
        Warning::FlushFaces { faces: vec!["z - 1 = 0".to_owned()] },
        Warning::Smoothed { share: 0.123_45, ratio: 12.345, position, length },
        Warning::Unused { names: vec!["c_rgb".to_owned(), "r".to_owned()] },
        Warning::Finer { spacing: 0.123456, resolution: 1.0 },
        Warning::Gradient { position, length },
        Warning::Count { count: 8_406, wanted: 8_000 },
        Warning::Unpaired { axis: 0, repeats: true },
        Warning::Unpaired { axis: 2, repeats: false },
        Warning::Children { not_converged: 12_345, undefined: 123, is_closed: false },
        Warning::Children { not_converged: 12_345, undefined: 123, is_closed: true },
        Warning::CloseSheets { count: 12_345 },
        Warning::Meets { crossings: 12, touches: 34, position, length },
        Warning::Rims { curves: 12, position, length },
        Warning::Crosses { curves: 12, position, length },
        Warning::Moved,
        Warning::EndedEarly { seeds: 123 },
        Warning::SmallFeatures { count: 123 },
        without(true),
        without(false),
        open(12, None),
        open(7, None),
        open(12, Some(EdgeSearch::Noisy)),
        open(12, Some(EdgeSearch::Grid { cells: 64 })),
        open(0, None),
        Warning::Jumps { position, length },
        Warning::MeshDiffers { components: [1, 2], euler: [2, 4] },
        Warning::MeshHoles { count: 12 },
        Warning::MeshTouches { count: 12 },
        Warning::MeshLeavesOut { count: 12 },
        Warning::LargerInside(Inside::Both),
        unproven(Doubt::NoBounds),
        unproven(Doubt::Creases),
        unproven(Doubt::Unfinished),
        unproven(Doubt::Unresolved { position, gap: 1.0e-7, least: 1.0e-6 }),
        unproven(Doubt::Cells { count: 28_264, position, size: 0.045 }),
        unproven(Doubt::Witnesses { count: 12, position }),
        Warning::Digits { position, distance: 1.0e-3, spacing: 0.01 },
        Warning::Overflow,
    ];
    for warning in warnings {
        let text = warning.to_string();
        let first = text.split(". ").next().unwrap_or_default();
        assert!(first.len() <= FIRST_SENTENCE, "{} letters: {first}", first.len());
        for word in ["child", "cell of", "undecided", "converge", "survey", "seed", "NaN"] {
            assert!(!first.contains(word), "{word}: {first}");
        }
        assert!(text.ends_with('.') || matches!(warning, Warning::SampledAs { .. }), "{text}");
    }
}
