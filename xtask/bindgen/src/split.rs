//! Cuts a bound module in two: a first part, which is all that a page has to wait for, and the rest, which joins it later.
//!
//! The first part keeps the exports, the memory and the function table. A function of the rest that it refers to is left in it
//! as a stub of a few bytes, which calls through a slot of the table. The rest imports from the first part all that it uses of
//! it, and enters its functions into their slots, and its constants into the memory, when it is instantiated. Between functions
//! of one part nothing changes.
//!
//! A stub that finds its slot empty first calls [`BRING`], which has to join the rest at once: a page need not know what is
//! where, only see to it that the rest is there when it is likely to be needed. [`GLUE`] is what JavaScript gets for both.
//!
//! (Binaryen's `wasm-split` does much the same, but leaves the constants where they are; and it is not among the tools that its
//! npm package brings.)

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use anyhow::{Context, Result, bail};
use walrus::ir::{Call, RefFunc, Value, Visitor, dfs_in_order};
use walrus::{
    ConstExpr, DataKind, ElementItems, ElementKind, ExportItem, FunctionBuilder, FunctionId, FunctionKind,
    GlobalId, GlobalKind, ImportKind, ImportedFunction, Module, TableId,
};

use crate::constants::Constants;

/// Module name under which the rest imports from the first part.
const FIRST: &str = "first";

/// Module name and name under which the first part imports what joins the rest.
const BRING: [&str; 2] = ["rest", "bring"];

/// Where the script of the binding lists what the module imports.
const IMPORTS: &str = r#"_bg.js": import0,"#;

/// Added to the script.
const GLUE: &str = r#"
let isWhole = false;
let bring = () => { throw new Error('The rest of the module is called before it is there.'); };

/**
 * Joins the rest to the module, once.
 * @param {WebAssembly.Module} rest
 */
export function join(rest) {
    if (isWhole) return;
    new WebAssembly.Instance(rest, { first: wasm });
    isWhole = true;
}

/**
 * Says where the rest comes from if it is called before it has been joined: at once, there is no waiting within a call.
 * @param {() => WebAssembly.Module} how
 */
export function whenMissing(how) {
    bring = how;
}
"#;

/// Added to its type declarations.
pub(crate) const TYPES: &str = "
/** Joins the rest to the module, once. */
export function join(rest: WebAssembly.Module): void;

/** Says where the rest comes from if it is called before it has been joined. */
export function whenMissing(how: () => WebAssembly.Module): void;
";

/// The script of the binding, made to join the rest.
///
/// # Errors
///
/// If the script is not as expected.
pub(crate) fn script(bound: &str) -> Result<String> {
    let Some((before, after)) = bound.split_once(IMPORTS) else {
        bail!("the script of the binding has no `{IMPORTS}`: has wasm-bindgen changed?");
    };
    let [module, name] = BRING;
    Ok(format!("{before}{IMPORTS}\n        {module}: {{ {name}: () => join(bring()) }},{after}{GLUE}"))
}

/// The two parts of the module `bound`, which was `linked` with relocations and keeps its mangled names. The rest are the
/// functions whose names contain one of the `later` words, those that only such functions call, and the constants that only
/// such functions use.
///
/// # Errors
///
/// If a module does not parse, has no function table or one filled in another way than by lists of functions, or if one of the
/// words is in no name.
pub(crate) fn split(linked: &[u8], bound: &[u8], later: &[String]) -> Result<(Vec<u8>, Vec<u8>)> {
    let constants = Constants::read(linked)?;
    let mut first = Module::from_buffer(bound).context("the bound module does not parse")?;
    // The two agree on the index of a function, not on its identifier.
    let mut rest = Module::from_buffer(bound)?;
    let moved = moved(&first, later)?;
    let unused = unused(&first, &moved, &constants)?;
    let slots = leave_stubs(&mut first, &moved)?;
    keep_only(&mut rest, &moved, &slots)?;
    move_constants(&mut first, &mut rest, &unused)?;
    walrus::passes::gc::run(&mut rest);
    export_imports(&mut first, &rest)?;
    walrus::passes::gc::run(&mut first);
    for module in [&mut first, &mut rest] {
        // The relocations no longer hold.
        let is_outdated = |name: &str| name == "linking" || name.starts_with("reloc.");
        for id in
            ids(module.customs.iter().filter(|(_, section)| is_outdated(section.name())).map(|(id, _)| id))
        {
            module.customs.delete(id);
        }
    }
    Ok((first.emit_wasm(), rest.emit_wasm()))
}

/// Index of a function in the module as it was.
type Index = usize;

/// Functions that a function refers to.
#[derive(Default)]
struct Callees(Vec<FunctionId>);

impl<'a> Visitor<'a> for Callees {
    fn visit_call(&mut self, call: &Call) {
        self.0.push(call.func);
    }

    fn visit_ref_func(&mut self, reference: &RefFunc) {
        self.0.push(reference.func);
    }
}

fn callees(module: &Module, function: FunctionId) -> Vec<FunctionId> {
    let FunctionKind::Local(local) = &module.funcs.get(function).kind else { return Vec::new() };
    let mut callees = Callees::default();
    dfs_in_order(&mut callees, local, local.entry_block());
    callees.0
}

/// The entries of the function table: slot and function.
fn table_entries(module: &Module) -> Result<Vec<(u32, FunctionId)>> {
    let mut entries = Vec::new();
    for element in module.elements.iter() {
        let (
            ElementKind::Active { offset: ConstExpr::Value(Value::I32(offset)), .. },
            ElementItems::Functions(functions),
        ) = (&element.kind, &element.items)
        else {
            bail!("the function table is filled by something else than a list of functions at a fixed place");
        };
        entries.extend((*offset as u32..).zip(functions.iter().copied()));
    }
    Ok(entries)
}

/// The functions of the rest.
fn moved(module: &Module, later: &[String]) -> Result<BTreeSet<Index>> {
    let mut unmatched: BTreeSet<&str> = later.iter().map(String::as_str).collect();
    let mut cut = BTreeSet::new();
    for (id, _) in module.funcs.iter_local() {
        // The two ways of mangling differ in where they write angle brackets.
        let name = format!("{:#}", rustc_demangle::demangle(name_of(module, id))).replace(['<', '>'], "");
        // What drops a value bears the name of its type, and is needed by whoever may hold one.
        if name.starts_with("core::ptr::drop_in_place") {
            continue;
        }
        for word in later.iter().filter(|word| name.contains(word.as_str())) {
            unmatched.remove(word.as_str());
            cut.insert(id);
        }
    }
    if !unmatched.is_empty() {
        bail!("no function has a name with {unmatched:?}: was it renamed, or inlined where it is called?");
    }
    let exported = module.exports.iter().filter_map(|export| match export.item {
        ExportItem::Function(function) => Some(function),
        _ => None,
    });
    let mut open: Vec<FunctionId> =
        exported.chain(table_entries(module)?.into_iter().map(|entry| entry.1)).chain(module.start).collect();
    let mut kept = BTreeSet::new();
    while let Some(function) = open.pop() {
        if !cut.contains(&function) && kept.insert(function) {
            open.extend(callees(module, function));
        }
    }
    let moved = module.funcs.iter_local().map(|(id, _)| id).filter(|id| !kept.contains(id));
    Ok(moved.map(|id| id.index()).collect())
}

fn name_of(module: &Module, function: FunctionId) -> &str {
    module.funcs.get(function).name.as_deref().unwrap_or_default()
}

/// Where constants lie that only the functions that have moved use.
fn unused(module: &Module, moved: &BTreeSet<Index>, constants: &Constants) -> Result<Vec<Range<u32>>> {
    // What the binding adds are wrappers, which use no data of their own.
    const WRAPPER: &str = " shim";
    let mut used = Vec::new();
    for (id, _) in module.funcs.iter_local().filter(|(id, _)| !moved.contains(&id.index())) {
        let name = name_of(module, id);
        match constants.of(name) {
            Some(symbols) => used.extend(symbols),
            None if name.ends_with(WRAPPER) => {}
            None => bail!("the linker knew no function `{name}`, nor what constants it uses"),
        }
    }
    Ok(constants.beyond(used))
}

/// Moves the constants at `places` from the first part to the rest.
fn move_constants(first: &mut Module, rest: &mut Module, places: &[Range<u32>]) -> Result<()> {
    let memory = rest.memories.iter().next().context("the module has no memory")?.id();
    for id in ids(first.data.iter().map(walrus::Data::id)) {
        let data = first.data.get_mut(id);
        let DataKind::Active { offset: ConstExpr::Value(Value::I32(start)), .. } = data.kind else {
            bail!("a data segment without a fixed place");
        };
        let start = start as u32;
        let end = start + data.value.len() as u32;
        for place in places.iter().filter(|place| start <= place.start && place.end <= end) {
            let bytes = &mut data.value[(place.start - start) as usize..(place.end - start) as usize];
            let offset = ConstExpr::Value(Value::I32(place.start as i32));
            let moved = rest.data.add(DataKind::Active { memory, offset }, bytes.to_vec());
            rest.memories.get_mut(memory).data_segments.insert(moved);
            // wasm-opt leaves zeros out.
            bytes.fill(0);
        }
    }
    Ok(())
}

fn function_table(module: &Module) -> Result<TableId> {
    module.tables.main_function_table()?.context("the module has no function table")
}

/// Replaces each function that has moved by a call through the table; returns the slots.
fn leave_stubs(first: &mut Module, moved: &BTreeSet<Index>) -> Result<BTreeMap<Index, u32>> {
    let functions = ids(first.funcs.iter_local().map(|(id, _)| id));
    let nothing = first.types.add(&[], &[]);
    let (bring, _) = first.add_import_func(BRING[0], BRING[1], nothing);
    let table_id = function_table(first)?;
    let table = first.tables.get_mut(table_id);
    let slots_from = u32::try_from(table.initial)?;
    table.initial += moved.len() as u64;
    table.maximum = table.maximum.map(|most| most + moved.len() as u64);
    let mut slots = BTreeMap::new();
    let functions = functions.into_iter().filter(|id| moved.contains(&id.index()));
    for (slot, function) in (slots_from..).zip(functions) {
        let ty = first.funcs.get(function).ty();
        let (params, results) = first.types.params_results(ty);
        let (params, results) = (params.to_vec(), results.to_vec());
        let arguments: Vec<_> = params.iter().map(|&ty| first.locals.add(ty)).collect();
        let mut stub = FunctionBuilder::new(&mut first.types, &params, &results);
        let mut body = stub.func_body();
        body.i32_const(slot as i32).table_get(table_id).ref_is_null();
        body.if_else(
            None,
            |missing| {
                missing.call(bring);
            },
            |_| {},
        );
        for &argument in &arguments {
            body.local_get(argument);
        }
        body.i32_const(slot as i32).call_indirect(ty, table_id);
        first.funcs.get_mut(function).kind = FunctionKind::Local(stub.local_func(arguments));
        slots.insert(function.index(), slot);
    }
    Ok(slots)
}

/// Makes the module that of the functions that have moved alone.
fn keep_only(rest: &mut Module, moved: &BTreeSet<Index>, slots: &BTreeMap<Index, u32>) -> Result<()> {
    // Besides its own slot a function has those that pointers to it stand for.
    let mut entries = table_entries(rest)?;
    entries.retain(|(_, function)| moved.contains(&function.index()));
    entries
        .extend(rest.funcs.iter_local().filter_map(|(id, _)| slots.get(&id.index()).map(|&slot| (slot, id))));
    entries.sort_unstable_by_key(|entry| entry.0);

    rest.start = None;
    for id in ids(rest.exports.iter().map(walrus::Export::id)) {
        rest.exports.delete(id);
    }
    for id in ids(rest.elements.iter().map(walrus::Element::id)) {
        rest.elements.delete(id);
    }
    for memory in ids(rest.memories.iter().map(walrus::Memory::id)) {
        let import = rest.imports.add(FIRST, "memory", memory);
        let memory = rest.memories.get_mut(memory);
        memory.import = Some(import);
        memory.data_segments = Default::default();
    }
    for id in ids(rest.data.iter().map(walrus::Data::id)) {
        rest.data.delete(id);
    }
    for import in ids(rest.imports.iter().map(walrus::Import::id)) {
        if let ImportKind::Function(function) = rest.imports.get(import).kind {
            let name = format!("i{}", function.index());
            let import = rest.imports.get_mut(import);
            (import.module, import.name) = (FIRST.to_owned(), name);
        }
    }
    for (index, global) in ids(rest.globals.iter().map(walrus::Global::id)).into_iter().enumerate() {
        let import = rest.imports.add(FIRST, &format!("g{index}"), global);
        rest.globals.get_mut(global).kind = GlobalKind::Import(import);
    }
    for function in ids(rest.funcs.iter_local().map(|(id, _)| id)) {
        if !moved.contains(&function.index()) {
            let ty = rest.funcs.get(function).ty();
            let import = rest.imports.add(FIRST, &format!("f{}", function.index()), function);
            rest.funcs.get_mut(function).kind = FunctionKind::Import(ImportedFunction { import, ty });
        }
    }
    let table_id = function_table(rest)?;
    for id in ids(rest.tables.iter().map(walrus::Table::id)) {
        let import = rest.imports.add(FIRST, &format!("t{}", id.index()), id);
        let table = rest.tables.get_mut(id);
        table.import = Some(import);
        table.elem_segments = Default::default();
        if id == table_id {
            table.initial += slots.len() as u64;
            table.maximum = table.maximum.map(|most| most + slots.len() as u64);
        }
    }
    for run in entries.chunk_by(|a, b| a.0 + 1 == b.0) {
        let offset = ConstExpr::Value(Value::I32(run[0].0 as i32));
        let functions = run.iter().map(|entry| entry.1).collect();
        let element = rest
            .elements
            .add(ElementKind::Active { table: table_id, offset }, ElementItems::Functions(functions));
        rest.tables.get_mut(table_id).elem_segments.insert(element);
    }
    Ok(())
}

/// Exports from the first part what the rest imports.
fn export_imports(first: &mut Module, rest: &Module) -> Result<()> {
    let functions: BTreeMap<Index, FunctionId> =
        first.funcs.iter().map(|f| (f.id().index(), f.id())).collect();
    let tables: BTreeMap<Index, TableId> = first.tables.iter().map(|t| (t.id().index(), t.id())).collect();
    let globals: BTreeMap<Index, GlobalId> = first.globals.iter().map(|g| (g.id().index(), g.id())).collect();
    for import in rest.imports.iter() {
        let item: ExportItem = match import.kind {
            ImportKind::Function(id) => functions[&id.index()].into(),
            ImportKind::Global(id) => globals[&id.index()].into(),
            ImportKind::Table(id) => tables[&id.index()].into(),
            // Exported to JavaScript under the same name.
            ImportKind::Memory(_) => continue,
            ImportKind::Tag(_) => bail!("the rest would import a tag"),
        };
        first.exports.add(&import.name, item);
    }
    Ok(())
}

/// The identifiers at hand before the module is changed.
fn ids<Id>(all: impl Iterator<Item = Id>) -> Vec<Id> {
    all.collect()
}
