//! Writes the types of what crosses to the page as TypeScript and the numbers by which it reads
//! columns as JavaScript, and holds the page's files to them.

use crate::field::model::SolvedModel;
use crate::lesson::{self, LessonField};
use crate::particles::{Particles, SlotFate, Slots};
use crate::pointcloud::job;
use crate::quality::Measurements;
use crate::remesh::MeshChange;
use crate::run::{Measured, Measures, MeshAnswer, Report, Start};
use crate::sampler::Progress;
use crate::session::{
    Code, Description, Fault, FieldAnswer, FieldRequest, FileRecord, FileRequest, ImageFacts, ImagePromise,
};
use std::collections::BTreeMap;
use std::path::Path;
use ts_rs::{Config, TS, TypeVisitor};

const HEAD: &str = "\
// The types of what the core, the solver for points and the lesson say and are told. Written from
// the Rust types by a test: UPDATE_GOLDEN=1 cargo test --lib page_types

/** What a command is answered: the fields of the value, or the error. */
export type Answer<T, E> = ({ ok: true } & T) | { ok: false; error: E };
";

/// The declarations of types and of all that they are made of, by name.
struct Declarations {
    config: Config,
    found: BTreeMap<String, String>,
}

impl Declarations {
    fn add<T: TS + 'static + ?Sized>(&mut self) {
        let docs = T::docs().unwrap_or_default();
        let declaration = tidy(&format!("{}\nexport {}", docs.trim_end(), T::decl(&self.config)));
        match self.found.insert(T::ident(&self.config), declaration.clone()) {
            None => T::visit_dependencies(self),
            Some(other) => assert_eq!(other, declaration, "two types have one name"),
        }
    }
}

impl TypeVisitor for Declarations {
    fn visit<T: TS + 'static + ?Sized>(&mut self) {
        // Numbers, texts and lists are named by those who use them.
        if T::output_path().is_some() {
            self.add::<T>();
        }
        T::visit_generics(self);
    }
}

/// The declaration with one line for each field and each comment.
fn tidy(declaration: &str) -> String {
    let mut out = String::from("\n");
    let mut is_inside = false;
    for line in declaration.replace("/**\n * ", "/** ").replace("\n */", " */").lines().map(str::trim) {
        let (line, is_end) = match line.strip_suffix(" };") {
            Some(field) if is_inside => (field, true),
            _ => (line, false),
        };
        out += if is_inside && !line.is_empty() { "  " } else { "" };
        out += line;
        out += "\n";
        if is_end {
            out += "};\n";
        }
        is_inside = !is_end && (is_inside || line.ends_with('{'));
    }
    out
}

#[test]
fn types_of_the_page_are_those_of_the_core() {
    let mut declarations =
        Declarations { config: Config::new().with_large_int("number"), found: BTreeMap::new() };
    declarations.add::<Description>();
    declarations.add::<FieldRequest>();
    declarations.add::<FieldAnswer>();
    declarations.add::<ImageFacts>();
    declarations.add::<ImagePromise>();
    declarations.add::<FileRequest>();
    declarations.add::<FileRecord>();
    declarations.add::<Code>();
    declarations.add::<Fault>();
    declarations.add::<Start>();
    declarations.add::<Progress>();
    declarations.add::<Report>();
    declarations.add::<Measures>();
    declarations.add::<MeshAnswer>();
    declarations.add::<MeshChange>();
    declarations.add::<Measured>();
    declarations.add::<SolvedModel>();
    declarations.add::<job::PointsProgress>();
    declarations.add::<LessonField>();
    declarations.add::<lesson::LessonSettings>();
    declarations.add::<lesson::LessonProgress>();
    declarations.add::<lesson::Chapter>();
    declarations.add::<lesson::Event>();
    declarations.add::<lesson::Life>();
    declarations.add::<lesson::Iterate>();
    let text: String = std::iter::once(HEAD.to_owned()).chain(declarations.found.into_values()).collect();

    hold("core-types.d.ts", &text);
}

#[test]
fn numbers_of_the_page_are_those_of_the_core() {
    let fates = SlotFate::ALL.map(|fate| {
        let name = serde_json::to_string(&fate).expect("a fate has a name");
        format!("{}: {}", name.trim_matches('"'), fate as u32)
    });
    let text = format!(
        "\
// The numbers by which the page reads the columns of the core. Written from the Rust constants by a
// test: UPDATE_GOLDEN=1 cargo test --lib page_types

/** Parent index of a seed. */
export const NO_PARENT = {};
/** Component of a particle that the report leaves out. */
export const NO_COMPONENT = {};
/** Largest number of slots of a particle, and the bits of each: slot `k` has those from `SLOT_BITS * k` on. */
export const MOST_SLOTS = {};
export const SLOT_BITS = {};
/** Bit of `slots` that is set where a singular point of the surface lies within 2r of the particle. */
export const SINGULAR = {};
/** Fates of a slot. */
export const FATE = {{ {} }};
",
        Particles::NO_PARENT,
        Measurements::NO_COMPONENT,
        Slots::COUNT,
        Slots::BITS,
        Slots::SINGULAR,
        fates.join(", "),
    );
    hold("core-numbers.js", &text);
}

/// Holds a file of the page's engine to `text`, or writes it if that is asked for.
fn hold(name: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("www/src/engine").join(name);
    if std::env::var_os("UPDATE_GOLDEN").is_some_and(|value| value == "1") {
        std::fs::write(&path, text).expect("the file can be written");
    }
    let page = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        without_comments(&page) == without_comments(text),
        "{} is not what the core says: UPDATE_GOLDEN=1 cargo test --lib page_types",
        path.display()
    );
}

/// The declarations alone: what differs only in its comments is the same.
fn without_comments(text: &str) -> Vec<&str> {
    text.lines().filter(|line| !line.trim_start().starts_with(['/', '*'])).collect()
}
