//! Which functions use which constant data, from the relocations that the linker leaves (`--emit-relocs`; the format is that of
//! the WebAssembly tool conventions, "Linking").

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use anyhow::{Context, Result, bail, ensure};
use wasmparser::{
    DataKind, KnownCustom, Linking, Operator, Parser, Payload, RelocSectionReader, RelocationEntry,
    RelocationType, SymbolInfo,
};

/// The constants of a linked module and who refers to them.
pub(crate) struct Constants {
    /// Symbols: where each lies in the memory.
    symbols: Vec<Range<u32>>,
    /// Names of the functions, and the symbols that each refers to.
    functions: BTreeMap<String, Vec<usize>>,
    /// Pointers in the data: where they stand and the symbol that they point into.
    pointers: BTreeMap<u32, usize>,
    /// Where constants lie that nothing ever writes to.
    read_only: Vec<Range<u32>>,
}

impl Constants {
    /// Reads them from a module as the linker wrote it.
    ///
    /// # Errors
    ///
    /// If there are no relocations in it, or they do not say what is found where they point.
    pub(crate) fn read(wasm: &[u8]) -> Result<Self> {
        let mut bodies: Vec<Range<usize>> = Vec::new();
        let mut segments: Vec<(u32, Range<usize>)> = Vec::new();
        let (mut code_start, mut data_start) = (0, 0);
        let mut names: Vec<&str> = Vec::new();
        let mut symbols: Vec<SymbolInfo> = Vec::new();
        let mut relocations: Vec<RelocSectionReader> = Vec::new();
        let mut imported = 0;
        for payload in Parser::new(0).parse_all(wasm) {
            match payload? {
                Payload::ImportSection(section) => {
                    for import in section.into_imports() {
                        imported += usize::from(matches!(import?.ty, wasmparser::TypeRef::Func(_)));
                    }
                }
                Payload::CodeSectionStart { range, .. } => code_start = range.start,
                Payload::CodeSectionEntry(body) => bodies.push(body.range()),
                Payload::DataSection(section) => {
                    data_start = section.range().start;
                    for segment in section {
                        let segment = segment?;
                        let DataKind::Active { offset_expr, .. } = segment.kind else {
                            bail!("a passive data segment")
                        };
                        let Operator::I32Const { value } = offset_expr.get_operators_reader().read()? else {
                            bail!("a data segment without a fixed place");
                        };
                        let end = segment.range.end;
                        segments.push((value as u32, end - segment.data.len()..end));
                    }
                }
                Payload::CustomSection(section) => match section.as_known() {
                    KnownCustom::Linking(linking) => {
                        for part in linking.subsections() {
                            match part? {
                                Linking::SegmentInfo(infos) => {
                                    for info in infos {
                                        names.push(info?.name);
                                    }
                                }
                                Linking::SymbolTable(table) => {
                                    for symbol in table {
                                        symbols.push(symbol?);
                                    }
                                }
                                _ => {}
                            }
                        }
                    }
                    KnownCustom::Reloc(reader) => relocations.push(reader),
                    _ => {}
                },
                _ => {}
            }
        }
        ensure!(relocations.len() == 2 && names.len() == segments.len(), "the linker left no relocations");

        let place = |symbol: &SymbolInfo| match symbol {
            SymbolInfo::Data { symbol: Some(at), .. } => {
                let start = segments[at.index as usize].0 + at.offset;
                start..start + at.size
            }
            _ => 0..0,
        };
        let mut constants = Self {
            symbols: symbols.iter().map(place).collect(),
            functions: BTreeMap::new(),
            pointers: BTreeMap::new(),
            read_only: Vec::new(),
        };
        for (name, (start, bytes)) in names.iter().zip(&segments) {
            if name.starts_with(".rodata") {
                constants.read_only.push(*start..start + bytes.len() as u32);
            }
        }
        let mut name_of: BTreeMap<u32, Vec<&str>> = BTreeMap::new();
        for symbol in &symbols {
            if let SymbolInfo::Func { index, name: Some(name), .. } = symbol {
                name_of.entry(*index).or_default().push(name);
                constants.functions.entry((*name).to_owned()).or_default();
            }
        }
        for reader in relocations {
            for entry in reader.entries() {
                let entry = entry?;
                let Some(kind) = Address::of(&entry)? else { continue };
                let symbol = entry.index as usize;
                let expected = i64::from(constants.symbols[symbol].start) + entry.addend;
                let at =
                    entry.offset as usize + if kind == Address::Pointer { data_start } else { code_start };
                let found = kind.value(wasm.get(at..).context("a relocation beyond the end")?);
                ensure!(
                    found as u32 == expected as u32,
                    "a relocation of {expected:#x} stands at {found:#x}"
                );
                if kind == Address::Pointer {
                    let segment = segments.iter().find(|segment| segment.1.contains(&at));
                    let (start, bytes) = segment.context("a pointer outside the data")?;
                    constants.pointers.insert(start + (at - bytes.start) as u32, symbol);
                } else {
                    let body = bodies.partition_point(|body| body.end <= at);
                    let names =
                        name_of.get(&((imported + body) as u32)).context("a function without a symbol")?;
                    for &name in names {
                        constants.functions.entry(name.to_owned()).or_default().push(symbol);
                    }
                }
            }
        }
        Ok(constants)
    }

    /// The symbols that the function refers to; none if the linker knew no function of this name.
    pub(crate) fn of(&self, function: &str) -> Option<Vec<usize>> {
        if let Some(symbols) = self.functions.get(function) {
            return Some(symbols.clone());
        }
        // The binding takes a hash from the names of what is exported.
        let prefix = format!("{function}_");
        let mut hashed = self
            .functions
            .range(prefix.clone()..)
            .take_while(|(name, _)| name.starts_with(&prefix))
            .peekable();
        hashed.peek()?;
        Some(hashed.flat_map(|(_, symbols)| symbols).copied().collect())
    }

    /// Where constants lie that cannot be reached from those in `used`, in order.
    pub(crate) fn beyond(&self, used: Vec<usize>) -> Vec<Range<u32>> {
        let mut open = used;
        let mut reached = BTreeSet::new();
        while let Some(symbol) = open.pop() {
            if reached.insert(symbol) {
                open.extend(self.pointers.range(self.symbols[symbol].clone()).map(|pointer| *pointer.1));
            }
        }
        let mut unused = Vec::new();
        for all in &self.read_only {
            // Symbols may overlap: what counts is each byte. Those of no symbol are padding.
            let mut is_unused = vec![false; all.len()];
            for keep in [false, true] {
                for (symbol, place) in self.symbols.iter().enumerate() {
                    if reached.contains(&symbol) == keep && all.start <= place.start && place.end <= all.end {
                        is_unused[(place.start - all.start) as usize..(place.end - all.start) as usize]
                            .fill(!keep);
                    }
                }
            }
            let mut at = all.start;
            for run in is_unused.chunk_by(|a, b| a == b) {
                if run[0] {
                    unused.push(at..at + run.len() as u32);
                }
                at += run.len() as u32;
            }
        }
        unused
    }
}

/// How a relocation writes the address of a constant.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Address {
    /// Immediate of a load or store.
    Unsigned,
    /// Immediate of a constant instruction.
    Signed,
    /// Four bytes in the data.
    Pointer,
}

impl Address {
    /// None for what is no address of a constant.
    fn of(entry: &RelocationEntry) -> Result<Option<Self>> {
        Ok(match entry.ty {
            RelocationType::MemoryAddrLeb => Some(Self::Unsigned),
            RelocationType::MemoryAddrSleb => Some(Self::Signed),
            RelocationType::MemoryAddrI32 => Some(Self::Pointer),
            RelocationType::FunctionIndexLeb
            | RelocationType::TableIndexSleb
            | RelocationType::TableIndexI32
            | RelocationType::TypeIndexLeb
            | RelocationType::GlobalIndexLeb
            | RelocationType::TableNumberLeb => None,
            other => bail!("a relocation of a kind that is not expected here: {other:?}"),
        })
    }

    /// The address that stands at the beginning of `bytes`.
    fn value(self, bytes: &[u8]) -> i64 {
        if self == Self::Pointer {
            return bytes.first_chunk().map_or(-1, |&bytes| i64::from(u32::from_le_bytes(bytes)));
        }
        // Five bytes of seven bits each; the sign of an address never matters.
        bytes
            .iter()
            .take(5)
            .enumerate()
            .fold(0, |value, (i, &byte)| value | i64::from(byte & 0x7f) << (7 * i))
    }
}
