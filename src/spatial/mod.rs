//! Neighbour search: a sparse grid for points that are inserted one by one, linked lists by cell
//! for points in columns, and a tree for points that are given at once and unevenly distributed.
//!
//! The cells of the grid are cubes. Eight neighbouring cells (2 × 2 × 2) form a *brick*, which a
//! hash table with open addressing finds. The table holds the bricks themselves and is part of the
//! grid, since the front asks it several times for every particle. A cell stores its points in
//! blocks of eight with their coordinates, so a query reads a few contiguous blocks and compares
//! eight distances at a time. Memory is proportional to the number of occupied cells, and a query
//! costs the same among 10³ and 10⁶ points.

pub(crate) mod chains;
pub(crate) mod tree;

use crate::math::functions::ROUNDER;
use crate::math::{GOLDEN_RATIO, LANES, Lanes, NONE, push_gently};
use glam::{Vec3, Vec4};

/// Bits of a cell coordinate: three coordinates form one hash key.
const COORDINATE_BITS: u32 = 21;
const COORDINATE_MASK: u64 = (1 << COORDINATE_BITS) - 1;
/// Mean number of points in a block of eight, for points on a surface: the last block of each cell
/// is partly empty. With the cell side of the sampler the mean is 5.5.
const POINTS_PER_BLOCK: usize = 5;
/// Key of an empty table entry. No brick has it, because keys have 63 bits.
const EMPTY: u64 = u64::MAX;

#[derive(Clone, Copy)]
struct Brick {
    key: u64,
    /// Eight bits, one for each cell that has a block.
    occupied: u32,
    /// First block of each of the eight cells.
    head: [u32; 8],
}

const EMPTY_BRICK: Brick = Brick { key: EMPTY, occupied: 0, head: [NONE; 8] };

#[derive(Clone, Copy)]
struct Block {
    x: Lanes,
    y: Lanes,
    z: Lanes,
    index: [u32; LANES],
    next: u32,
    len: u32,
}

/// Handle of a point in the grid; valid until the grid is reset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CellHandle(u32);

/// A point found by [`CellGrid::gather`].
#[derive(Clone, Copy, Debug)]
pub struct Neighbour {
    /// Index given at insertion.
    pub index: u32,
    /// Squared distance from the centre of the query.
    pub distance_sq: f32,
    /// Position of the point less the centre of the query.
    pub offset: Vec3,
}

/// A query for the points within a radius of a centre.
#[derive(Clone, Copy)]
struct RadiusQuery {
    centre: Vec3,
    radius: f32,
}

/// Points that a query has found, as handles.
struct Hits {
    len: usize,
    places: [u32; 8 * LANES],
}

/// The indices of the lanes in a set of lanes, and their number.
#[derive(Clone, Copy)]
pub(crate) struct LanesOf {
    pub(crate) lane: [u32; LANES],
    pub(crate) count: usize,
}

/// The lanes of every set, given as bits. A query copies all entries and advances by their number:
/// the end of a loop over the set alone would be mispredicted.
pub(crate) static LANES_OF: [LanesOf; 1 << LANES] = {
    let mut all = [LanesOf { lane: [0; LANES], count: 0 }; 1 << LANES];
    let mut set = 0;
    while set < all.len() {
        let mut lane = 0;
        while lane < LANES {
            if set >> lane & 1 != 0 {
                all[set].lane[all[set].count] = lane as u32;
                all[set].count += 1;
            }
            lane += 1;
        }
        set += 1;
    }
    all
};

/// A sparse grid of cubic cells. The default one takes no points until it is [reset](Self::reset).
#[derive(Clone, Default)]
pub struct CellGrid {
    inverse_cell: f32,
    table: Vec<Brick>,
    bricks: usize,
    blocks: Vec<Block>,
}

impl CellGrid {
    /// Returns an empty grid with cells of the given side. Queries are fastest for radii near 0.8
    /// sides.
    ///
    /// # Panics
    ///
    /// If the side is not positive and finite.
    #[must_use]
    pub fn new(cell_side: f32) -> Self {
        let mut grid = Self::default();
        grid.reset(cell_side);
        grid
    }

    /// Removes all points and sets a new side. The memory is kept.
    ///
    /// # Panics
    ///
    /// If the side is not positive and finite.
    pub fn reset(&mut self, cell_side: f32) {
        assert!(cell_side > 0.0 && cell_side.is_finite(), "the cell side must be a positive number");
        self.inverse_cell = 1.0 / cell_side;
        self.table.fill(EMPTY_BRICK);
        if self.table.is_empty() {
            self.table.resize(64, EMPTY_BRICK);
        }
        self.bricks = 0;
        self.blocks.clear();
    }

    /// Reserves memory for this many points on a surface, so that the blocks need not grow.
    pub fn reserve(&mut self, points: usize) {
        self.blocks.reserve_exact((points / POINTS_PER_BLOCK).saturating_sub(self.blocks.len()));
    }

    /// Returns the coordinates of the cell of a point.
    fn cell(&self, point: Vec3) -> [u32; 3] {
        cell(point * self.inverse_cell)
    }

    /// Inserts a point and returns its handle. Queries return `index`.
    pub fn insert(&mut self, point: Vec3, index: u32) -> CellHandle {
        let (brick_key, cell) = self.cell_of(point);
        if 2 * (self.bricks + 1) > self.table.len() {
            self.grow();
        }
        let entry = self.find_or_add(brick_key);
        let mut head = self.table[entry].head[cell];
        if head == NONE || self.blocks[head as usize].len as usize == LANES {
            let block = Block {
                x: Lanes::splat(f32::INFINITY),
                y: Lanes::splat(f32::INFINITY),
                z: Lanes::splat(f32::INFINITY),
                index: [NONE; LANES],
                next: head,
                len: 0,
            };
            head = self.blocks.len() as u32;
            push_gently(&mut self.blocks, block);
            self.table[entry].head[cell] = head;
            self.table[entry].occupied |= 1 << cell;
        }
        let block = &mut self.blocks[head as usize];
        let lane = block.len as usize;
        block.len += 1;
        block.x.0[lane] = point.x;
        block.y.0[lane] = point.y;
        block.z.0[lane] = point.z;
        block.index[lane] = index;
        CellHandle(head * LANES as u32 + lane as u32)
    }

    /// Removes the point with this handle. Its memory is reused only after a reset.
    pub fn remove(&mut self, place: CellHandle) {
        let block = &mut self.blocks[place.0 as usize / LANES];
        block.x.0[place.0 as usize % LANES] = f32::INFINITY;
    }

    /// Moves the point with this handle to `point`, and gives it a new index.
    pub fn update(&mut self, place: CellHandle, point: Vec3, index: u32) {
        let (b, lane) = (place.0 as usize / LANES, place.0 as usize % LANES);
        let block = &mut self.blocks[b];
        let old = Vec3::new(block.x.0[lane], block.y.0[lane], block.z.0[lane]);
        let same_cell = self.cell(old) == self.cell(point);
        if same_cell {
            let block = &mut self.blocks[b];
            block.x.0[lane] = point.x;
            block.y.0[lane] = point.y;
            block.z.0[lane] = point.z;
            block.index[lane] = index;
        } else {
            self.remove(place);
            self.insert(point, index);
        }
    }

    /// Replaces the content of `found` by all points within `radius` of `centre`, the boundary
    /// included. Their order depends only on the history of insertions.
    pub fn gather(&self, centre: Vec3, radius: f32, found: &mut Vec<Neighbour>) {
        found.clear();
        self.gather_more(centre, radius, found);
    }

    /// Appends to `found` all points within `radius` of `centre`, the boundary included. Their
    /// order depends only on the history of insertions.
    pub fn gather_more(&self, centre: Vec3, radius: f32, found: &mut Vec<Neighbour>) {
        let mut hits = Hits { len: 0, places: [0; 8 * LANES] };
        let (lo, hi) = (self.cell(centre - radius), self.cell(centre + radius));
        for bz in lo[2] >> 1..=hi[2] >> 1 {
            let in_z = in_range(bz, lo[2], hi[2], [0b0000_1111, 0b1111_0000]);
            for by in lo[1] >> 1..=hi[1] >> 1 {
                let in_yz = in_z & in_range(by, lo[1], hi[1], [0b0011_0011, 0b1100_1100]);
                for bx in lo[0] >> 1..=hi[0] >> 1 {
                    let Some(brick) = self.find(key(bx, by, bz)) else { continue };
                    let in_x = in_range(bx, lo[0], hi[0], [0b0101_0101, 0b1010_1010]);
                    let mut cells = brick.occupied & in_x & in_yz;
                    while cells != 0 {
                        let cell = cells.trailing_zeros() as usize & 7;
                        cells &= cells - 1;
                        self.gather_cell(brick.head[cell], RadiusQuery { centre, radius }, &mut hits, found);
                    }
                }
            }
        }
        self.take(&mut hits, centre, found);
    }

    /// Appends the points of a cell that are within the radius to `hits`, which is moved to `found`
    /// whenever it is full.
    #[inline]
    fn gather_cell(
        &self,
        head: u32,
        RadiusQuery { centre, radius }: RadiusQuery,
        hits: &mut Hits,
        found: &mut Vec<Neighbour>,
    ) {
        let radius_sq = Vec4::splat(radius * radius);
        let mut next = head;
        while next != NONE {
            let block = &self.blocks[next as usize];
            let half = |k: usize| {
                let d = |lanes: &Lanes, c: f32| Vec4::from_slice(&lanes.0[k..k + 4]) - c;
                let (dx, dy, dz) = (d(&block.x, centre.x), d(&block.y, centre.y), d(&block.z, centre.z));
                (dx * dx + dy * dy + dz * dz).cmple(radius_sq).bitmask()
            };
            let near = (half(0) | half(4) << 4) as usize & 0xff;
            if hits.len > hits.places.len() - LANES {
                self.take(hits, centre, found);
            }
            let lanes = &LANES_OF[near];
            for (place, lane) in hits.places[hits.len..hits.len + LANES].iter_mut().zip(lanes.lane) {
                *place = next * LANES as u32 + lane;
            }
            hits.len += lanes.count;
            next = block.next;
        }
    }

    /// Moves the content of `hits` to `found`.
    fn take(&self, hits: &mut Hits, centre: Vec3, found: &mut Vec<Neighbour>) {
        found.extend(hits.places[..hits.len].iter().map(|&place| {
            let (block, lane) = (&self.blocks[place as usize / LANES], place as usize % LANES);
            let offset = Vec3::new(block.x.0[lane], block.y.0[lane], block.z.0[lane]) - centre;
            Neighbour { index: block.index[lane], distance_sq: offset.length_squared(), offset }
        }));
        hits.len = 0;
    }

    fn cell_of(&self, point: Vec3) -> (u64, usize) {
        let [x, y, z] = self.cell(point);
        (key(x >> 1, y >> 1, z >> 1), (x & 1 | (y & 1) << 1 | (z & 1) << 2) as usize)
    }

    fn slot(&self, key: u64) -> usize {
        (key.wrapping_mul(GOLDEN_RATIO) >> (64 - self.table.len().trailing_zeros())) as usize
    }

    fn find(&self, key: u64) -> Option<&Brick> {
        let mut slot = self.slot(key);
        loop {
            let brick = &self.table[slot];
            if brick.key == key {
                return Some(brick);
            }
            if brick.key == EMPTY {
                return None;
            }
            slot = (slot + 1) & (self.table.len() - 1);
        }
    }

    fn find_or_add(&mut self, key: u64) -> usize {
        let mut slot = self.slot(key);
        loop {
            if self.table[slot].key == key {
                return slot;
            }
            if self.table[slot].key == EMPTY {
                self.table[slot].key = key;
                self.bricks += 1;
                return slot;
            }
            slot = (slot + 1) & (self.table.len() - 1);
        }
    }

    fn grow(&mut self) {
        let new_len = (2 * self.table.len()).max(64);
        let old = core::mem::replace(&mut self.table, vec![EMPTY_BRICK; new_len]);
        self.bricks = 0;
        for brick in old.into_iter().filter(|brick| brick.key != EMPTY) {
            let slot = self.find_or_add(brick.key);
            self.table[slot] = brick;
        }
    }
}

/// The integers nearest to the coordinates of a point.
#[inline]
fn cell(point: Vec3) -> [u32; 3] {
    [coordinate(point.x), coordinate(point.y), coordinate(point.z)]
}

/// The integer nearest to `x`, offset so that it is not negative: non-decreasing in `x`.
fn coordinate(x: f32) -> u32 {
    // Cheaper than a conversion, which saturates. Cell sides are far above the spacing of the
    // coordinates, so 22 bits suffice.
    const CENTRE: u32 = 1 << (COORDINATE_BITS - 1);
    (x + ROUNDER).to_bits().wrapping_sub(ROUNDER.to_bits()).wrapping_add(CENTRE) & COORDINATE_MASK as u32
}

/// Cells of a brick whose coordinate on one axis is in `lo..=hi`; `halves` are the cells of the
/// lower and the upper half.
fn in_range(brick: u32, lo: u32, hi: u32, halves: [u32; 2]) -> u32 {
    let lower = if 2 * brick >= lo { halves[0] } else { 0 };
    let upper = if 2 * brick < hi { halves[1] } else { 0 };
    lower | upper
}

fn key(x: u32, y: u32, z: u32) -> u64 {
    (u64::from(x) & COORDINATE_MASK)
        | (u64::from(y) & COORDINATE_MASK) << COORDINATE_BITS
        | (u64::from(z) & COORDINATE_MASK) << (2 * COORDINATE_BITS)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every point of `points` within `radius` of `centre`, by looking at all of them: the oracle
    /// of [`CellGrid::gather`].
    pub(super) fn gather_naive(points: &[Vec3], centre: Vec3, radius: f32) -> Vec<u32> {
        let near = |p: &Vec3| {
            let d = *p - centre;
            d.x * d.x + d.y * d.y + d.z * d.z <= radius * radius
        };
        points.iter().enumerate().filter(|(_, p)| near(p)).map(|(i, _)| i as u32).collect()
    }

    pub(super) fn cloud(count: u32) -> Vec<Vec3> {
        // A Weyl sequence: well spread, deterministic, no two points alike.
        let step = Vec3::new(0.754_877_7, 0.569_840_3, 0.430_159_7);
        (0..count).map(|i| (step * i as f32).fract() * 4.0 - 2.0).collect()
    }

    #[test]
    fn gather_finds_what_the_naive_search_finds() {
        let points = cloud(3000);
        for side in [0.05, 0.3, 1.7] {
            let mut grid = CellGrid::new(side);
            for (i, &p) in points.iter().enumerate() {
                grid.insert(p, i as u32);
            }
            let mut found = Vec::new();
            for &centre in points.iter().step_by(37) {
                for radius in [0.0, 0.1, 0.4] {
                    grid.gather(centre, radius, &mut found);
                    let mut got: Vec<u32> = found.iter().map(|n| n.index).collect();
                    got.sort_unstable();
                    assert_eq!(got, gather_naive(&points, centre, radius), "side {side} radius {radius}");
                }
            }
        }
    }

    #[test]
    fn moved_and_removed_points_are_found_where_they_are_now() {
        let mut points = cloud(500);
        let mut grid = CellGrid::new(0.4);
        let places: Vec<_> = points.iter().enumerate().map(|(i, &p)| grid.insert(p, i as u32)).collect();
        for (i, place) in places.into_iter().enumerate() {
            if i % 3 == 0 {
                grid.remove(place);
                points[i] = Vec3::INFINITY;
            } else {
                points[i] += Vec3::new(0.05, -0.3, 0.01) * (i % 5) as f32;
                grid.update(place, points[i], i as u32);
            }
        }
        let mut found = Vec::new();
        for &centre in points.iter().filter(|p| p.is_finite()) {
            grid.gather(centre, 0.5, &mut found);
            let mut got: Vec<u32> = found.iter().map(|n| n.index).collect();
            got.sort_unstable();
            assert_eq!(got, gather_naive(&points, centre, 0.5));
        }
    }

    #[test]
    fn a_reset_grid_is_empty() {
        let mut grid = CellGrid::new(1.0);
        grid.insert(Vec3::ONE, 7);
        grid.reset(0.5);
        let mut found = Vec::new();
        grid.gather(Vec3::ONE, 1.0, &mut found);
        assert!(found.is_empty());
    }
}
