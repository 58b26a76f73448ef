//! Graph of a formula in static single-assignment (SSA) form.
//!
//! The graph is a list of operations in which operands precede their uses. Equal operations are one
//! node (hash-consing), and constants are folded.

use super::operations::{Binary, Unary};
use core::ops::Mul;
use glam::DVec3;

/// Index of a node. Operands have smaller indices than their uses.
pub(super) type Id = u32;

/// An operation. A constant is stored as its bits, so that nodes can be compared and ordered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Node {
    Constant(u64),
    Parameter(u32),
    Coordinate(u8),
    Unary(Unary, Id),
    Binary(Binary, Id, Id),
    /// Integer power with an exponent other than 0 and 1.
    Power(Id, i32),
    /// Smooth minimum of two values, with its blend width.
    Smin(Blend, Id, Id, Id),
    /// The third value where the first is at most the second, or, with `false`, where it is not;
    /// else 0.
    If(bool, Id, Id, Id),
    /// The third value where the first is at most the second, else the fourth; `true` if the last
    /// two are known to be equal where the first two are.
    Select(bool, Id, Id, Id, Id),
}

/// The polynomial of a smooth minimum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Blend {
    Quadratic,
    Cubic,
}

impl Node {
    pub(super) fn constant(value: f64) -> Self {
        Self::Constant(value.to_bits())
    }

    /// Calls `visit` with every operand.
    pub(super) fn operands(self, mut visit: impl FnMut(Id)) {
        match self {
            Self::Constant(_) | Self::Parameter(_) | Self::Coordinate(_) => {}
            Self::Unary(_, a) | Self::Power(a, _) => visit(a),
            Self::Binary(_, a, b) => {
                visit(a);
                visit(b);
            }
            Self::Smin(_, a, b, c) | Self::If(_, a, b, c) => [a, b, c].into_iter().for_each(visit),
            Self::Select(_, a, b, c, d) => [a, b, c, d].into_iter().for_each(visit),
        }
    }

    /// Returns the operation with every operand replaced through `map`.
    pub(super) fn mapped(self, map: impl Fn(Id) -> Id) -> Self {
        match self {
            Self::Constant(_) | Self::Parameter(_) | Self::Coordinate(_) => self,
            Self::Unary(operation, a) => Self::Unary(operation, map(a)),
            Self::Power(a, n) => Self::Power(map(a), n),
            Self::Binary(operation, a, b) => Self::Binary(operation, map(a), map(b)),
            Self::Smin(blend, a, b, c) => Self::Smin(blend, map(a), map(b), map(c)),
            Self::If(at_most, a, b, c) => Self::If(at_most, map(a), map(b), map(c)),
            Self::Select(joins, a, b, c, d) => Self::Select(joins, map(a), map(b), map(c), map(d)),
        }
    }

    /// Value of the node in double precision. `value` gives the values of its operands.
    pub(super) fn evaluate(self, parameters: &[f64], point: [f64; 3], value: impl Fn(Id) -> f64) -> f64 {
        match self {
            Self::Constant(bits) => f64::from_bits(bits),
            Self::Parameter(index) => parameters[index as usize],
            Self::Coordinate(axis) => point[usize::from(axis)],
            Self::Unary(operation, a) => operation.evaluate(value(a)),
            Self::Binary(operation, a, b) => operation.evaluate(value(a), value(b)),
            Self::Power(a, n) => power(value(a), n),
            Self::Smin(blend, a, b, k) => smin(blend, value(a), value(b), value(k)),
            Self::If(_, a, b, _) | Self::Select(_, a, b, ..) if value(a).is_nan() || value(b).is_nan() => {
                f64::NAN
            }
            Self::If(at_most, a, b, v) if (value(a) <= value(b)) == at_most => value(v),
            Self::If(..) => 0.0,
            Self::Select(_, a, b, u, v) => value(if value(a) <= value(b) { u } else { v }),
        }
    }
}

/// x^n by repeated squaring. For n < 0 the reciprocal is raised to −n.
pub(super) fn power(x: f64, n: i32) -> f64 {
    whole_power(1.0, if n < 0 { 1.0 / x } else { x }, n.unsigned_abs())
}

/// x^n by repeated squaring, from the `one` of these numbers.
pub(super) fn whole_power<T: Copy + Mul<Output = T>>(one: T, x: T, n: u32) -> T {
    let (mut square, mut rest, mut result) = (x, n, one);
    while rest > 0 {
        if rest & 1 == 1 {
            result = result * square;
        }
        square = square * square;
        rest >>= 1;
    }
    result
}

/// Smallest blend width of a smooth minimum. Smaller and negative widths are raised to it: the
/// second derivatives are up to its inverse, and no picture shows a blend as narrow.
pub(super) const MIN_BLEND_WIDTH: f64 = 1e-9;

/// Smooth minimum min(a, b) − k (1 − |u|)³/6 with u = (a − b)/k clamped to −1 … 1, or min(a, b) − k
/// (1 − |u|)²/4. It equals the minimum where |a − b| ≥ k and is continuously differentiable, the
/// cubic one twice (I. Quilez, "Smooth minimum", 2013).
pub(super) fn smin(blend: Blend, a: f64, b: f64, k: f64) -> f64 {
    let k = Binary::Max.evaluate(k, MIN_BLEND_WIDTH);
    let gap = 1.0 - Binary::Min.evaluate(((a - b) / k).abs(), 1.0);
    let depth = match blend {
        Blend::Cubic => k * (gap * gap * gap) / 6.0,
        Blend::Quadratic => k * (gap * gap) / 4.0,
    };
    Binary::Min.evaluate(a, b) - depth
}

/// The nodes, with the coordinates that each depends on.
#[derive(Clone, Debug, Default)]
pub(super) struct Graph {
    nodes: Vec<Node>,
    /// Coordinates that each node depends on: bit k stands for coordinate k.
    axes: Vec<u8>,
    /// The nodes in the order of `Node`, for binary search.
    sorted: Vec<Id>,
    /// Whether a product with the constant 0 folds to 0. It does in derivatives, where 0 means
    /// independence of the coordinate. It does not in the formula itself: `0*ln(x)` is undefined
    /// for negative x.
    zero_annihilates: bool,
    /// Whether sums keep the order in which they are written.
    keeps_sums: bool,
}

impl Graph {
    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }

    pub(super) fn node(&self, id: Id) -> Node {
        self.nodes[id as usize]
    }

    pub(super) fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Coordinates that the node depends on: bit k stands for coordinate k.
    pub(super) fn axes(&self, id: Id) -> u8 {
        self.axes[id as usize]
    }

    /// Whether the node depends on no coordinate.
    pub(super) fn is_uniform(&self, id: Id) -> bool {
        self.axes(id) == 0
    }

    /// The summands of a node, each once with its coefficient, in the order of the graph.
    pub(super) fn summands(&self, root: Id) -> Vec<(Id, f64)> {
        self.gathered(&[(root, 1.0)])
    }

    fn gathered(&self, terms: &[(Id, f64)]) -> Vec<(Id, f64)> {
        let mut shares = vec![0.0; self.len()];
        let mut open = terms.to_vec();
        while let Some((id, share)) = open.pop() {
            match self.node(id) {
                Node::Binary(Binary::Add, u, v) => open.extend([(u, share), (v, share)]),
                Node::Binary(Binary::Sub, u, v) => open.extend([(u, share), (v, -share)]),
                Node::Unary(Unary::Neg, u) => open.push((u, -share)),
                _ => shares[id as usize] += share,
            }
        }
        (0..).zip(shares).filter(|&(_, share)| share != 0.0).collect()
    }

    /// The node of a weighted sum with like terms collected.
    pub(super) fn combination(&mut self, terms: [(Id, f64); 2]) -> Id {
        let mut sum = self.constant(0.0);
        for (id, share) in self.gathered(&terms) {
            let share = self.constant(share);
            let term = self.mul(id, share);
            sum = self.add(sum, term);
        }
        sum
    }

    /// The functions whose zeros together are the zeros of `root`, each once; none if `root`
    /// depends on no coordinate.
    ///
    /// A product is taken apart into its factors, a power into its base, and a function that
    /// vanishes only at 0 into its argument.
    pub(super) fn factors(&self, root: Id) -> Vec<Id> {
        let mut factors = Vec::new();
        let mut open = vec![root];
        while let Some(id) = open.pop() {
            match self.node(id) {
                _ if self.is_uniform(id) => {}
                Node::Binary(Binary::Mul, a, b) => open.extend([b, a]),
                Node::Binary(Binary::Div, a, _) => open.push(a),
                Node::Power(a, n) if n > 0 => open.push(a),
                Node::Power(_, _) => {}
                Node::Unary(
                    Unary::Neg
                    | Unary::Sqrt
                    | Unary::Cbrt
                    | Unary::Abs
                    | Unary::Atan
                    | Unary::Sinh
                    | Unary::Tanh
                    | Unary::Asinh
                    | Unary::Atanh
                    | Unary::Erf,
                    a,
                ) => open.push(a),
                _ if factors.contains(&id) => {}
                _ => factors.push(id),
            }
        }
        factors
    }

    /// If `root` is a sum of even powers, a root of one, or the negative of such a sum: the
    /// functions that vanish together where it does. Otherwise none.
    pub(super) fn squares(&self, mut root: Id) -> Vec<Id> {
        if let Node::Unary(Unary::Neg, sum) = self.node(root) {
            root = sum;
        }
        let (mut open, mut squares, mut next) = (vec![root], Vec::new(), 0);
        while let Some(&id) = open.get(next) {
            next += 1;
            let mut add = |id: Id| {
                if !open.contains(&id) {
                    open.push(id);
                }
            };
            match self.node(id) {
                Node::Unary(Unary::Sqrt, a) => add(a),
                Node::Binary(Binary::Add, a, b) => [a, b].into_iter().for_each(add),
                Node::Power(a, n) if n > 0 && n % 2 == 0 => squares.push(a),
                _ => return Vec::new(),
            }
        }
        squares
    }

    /// Whether a node is the root of a sum of squares.
    pub(super) fn is_norm(&self, id: Id) -> bool {
        let Node::Unary(Unary::Sqrt, sum) = self.node(id) else { return false };
        let mut open = vec![sum];
        while let Some(id) = open.pop() {
            match self.node(id) {
                Node::Binary(Binary::Add, a, b) => open.extend([a, b]),
                Node::Power(_, 2) => {}
                _ => return false,
            }
        }
        true
    }

    /// The function of a surface and the function that limits it; none without limits.
    pub(super) fn limited(&self, root: Id) -> Option<[Id; 2]> {
        let Node::Binary(Binary::Max, f, limit) = self.node(root) else { return None };
        let Node::Unary(Unary::Limit, limit) = self.node(limit) else { return None };
        Some([f, limit])
    }

    /// The nodes that `outputs` need, in the order of the graph.
    pub(super) fn needed_by(&self, outputs: &[Id]) -> Vec<Id> {
        let mut needed = vec![false; self.nodes.len()];
        for &output in outputs {
            needed[output as usize] = true;
        }
        // Operands have smaller indices than their uses.
        for (id, node) in self.nodes.iter().enumerate().rev() {
            if needed[id] {
                node.operands(|operand| needed[operand as usize] = true);
            }
        }
        (0..).zip(needed).filter(|&(_, is_needed)| is_needed).map(|(id, _)| id).collect()
    }

    /// Evaluates `nodes` at a point, and writes the value of each to `results` at its index. The
    /// operands of each must be among the nodes.
    pub(super) fn evaluate(&self, nodes: &[Id], parameters: &[f64], point: DVec3, results: &mut Vec<f64>) {
        let point = point.to_array();
        results.resize(self.nodes.len().max(results.len()), 0.0);
        for &id in nodes {
            let value = self.nodes[id as usize].evaluate(parameters, point, |id| results[id as usize]);
            results[id as usize] = value;
        }
    }

    pub(super) fn as_constant(&self, id: Id) -> Option<f64> {
        match self.node(id) {
            Node::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    /// Folds products with the constant 0 from now on; for derivatives.
    pub(super) fn let_zero_annihilate(&mut self) {
        self.zero_annihilates = true;
    }

    /// Leaves sums in their order from now on: in another order they round differently.
    pub(super) fn keep_sums(&mut self) {
        self.keeps_sums = true;
    }

    /// Index of the node, if it exists.
    pub(super) fn find(&self, node: Node) -> Option<Id> {
        self.place(node).ok().map(|at| self.sorted[at])
    }

    /// Place of the node among the sorted ones, or the place to insert it at.
    fn place(&self, node: Node) -> Result<usize, usize> {
        self.sorted.binary_search_by(|&id| self.node(id).cmp(&node))
    }

    /// Index of the node, which is added without simplification if it does not exist.
    pub(super) fn intern(&mut self, node: Node) -> Id {
        let at = match self.place(node) {
            Ok(at) => return self.sorted[at],
            Err(at) => at,
        };
        let mut axes = if let Node::Coordinate(axis) = node { 1 << axis } else { 0 };
        node.operands(|operand| axes |= self.axes[operand as usize]);
        let id = u32::try_from(self.nodes.len()).unwrap_or(u32::MAX);
        self.nodes.push(node);
        self.axes.push(axes);
        self.sorted.insert(at, id);
        id
    }

    /// Index of the operation, simplified as when a formula is built.
    pub(super) fn built(&mut self, node: Node) -> Id {
        match node {
            Node::Constant(_) | Node::Parameter(_) | Node::Coordinate(_) => self.intern(node),
            Node::Unary(operation, a) => self.unary(operation, a),
            Node::Binary(operation, a, b) => self.binary(operation, a, b),
            Node::Power(a, n) => self.power(a, n),
            Node::Smin(blend, a, b, k) => self.smin(blend, a, b, k),
            Node::If(at_most, a, b, value) => self.when(at_most, a, b, value),
            Node::Select(_, a, b, u, v) => self.select(a, b, u, v),
        }
    }

    /// The graph of node `root` alone, in the same order, with the node's index in it.
    pub(super) fn part(&self, root: Id) -> (Self, Id) {
        let (part, roots) = self.rewritten(&[root], Self::intern);
        (part, roots[0])
    }

    /// Adds node `root` of another graph, with what it needs, and returns its index in this one.
    pub(super) fn add_part(&mut self, other: &Self, root: Id) -> Id {
        let mut map = vec![0; other.len()];
        for id in other.needed_by(&[root]) {
            map[id as usize] = self.built(other.node(id).mapped(|operand| map[operand as usize]));
        }
        map[root as usize]
    }

    /// A graph of `outputs`, and their indices in it: `write` adds each node that they need, in the
    /// same order.
    pub(super) fn rewritten(
        &self,
        outputs: &[Id],
        mut write: impl FnMut(&mut Self, Node) -> Id,
    ) -> (Self, Vec<Id>) {
        let mut other = Self::default();
        let mut map = vec![0; self.len()];
        for id in self.needed_by(outputs) {
            map[id as usize] = write(&mut other, self.node(id).mapped(|operand| map[operand as usize]));
        }
        (other, outputs.iter().map(|&output| map[output as usize]).collect())
    }

    /// Index of `node`, or of its value if all operands are constants.
    fn folded(&mut self, node: Node) -> Id {
        let mut constant = true;
        node.operands(|operand| constant &= matches!(self.node(operand), Node::Constant(_)));
        if constant {
            let value = node.evaluate(&[], [0.0; 3], |id| self.as_constant(id).unwrap_or(f64::NAN));
            return self.constant(value);
        }
        self.intern(node)
    }

    pub(super) fn constant(&mut self, value: f64) -> Id {
        self.intern(Node::constant(value))
    }

    fn is(&self, id: Id, value: f64) -> bool {
        self.as_constant(id) == Some(value)
    }

    /// Operands of a commutative operation in canonical order, so that a + b and b + a are one
    /// node. A uniform operand comes second.
    fn ordered(&self, a: Id, b: Id) -> (Id, Id) {
        let key = |id: Id| (self.is_uniform(id), id);
        if key(a) <= key(b) { (a, b) } else { (b, a) }
    }

    pub(super) fn add(&mut self, a: Id, b: Id) -> Id {
        if self.is(a, 0.0) {
            return b;
        }
        if self.is(b, 0.0) {
            return a;
        }
        match (self.node(a), self.node(b)) {
            // A varying operand plus a negated uniform stays a sum: `sub` would turn it back into
            // one.
            (_, Node::Unary(Unary::Neg, inner)) if !self.is_uniform(inner) || self.is_uniform(a) => {
                return self.sub(a, inner);
            }
            (Node::Unary(Unary::Neg, inner), _) if !self.is_uniform(inner) || self.is_uniform(b) => {
                return self.sub(b, inner);
            }
            _ => {}
        }
        let (a, b) = self.ordered(a, b);
        if self.keeps_sums {
            return self.folded(Node::Binary(Binary::Add, a, b));
        }
        // (v + u) + w = v + (u + w) for uniform u and w saves one operation per point.
        if self.is_uniform(b)
            && let Node::Binary(Binary::Add, v, u) = self.node(a)
            && self.is_uniform(u)
            && !self.is_uniform(v)
        {
            let sum = self.add(u, b);
            return self.add(v, sum);
        }
        // (u − v) + w = (u + w) − v likewise: coplanar faces of boxes become one function.
        if self.is_uniform(b)
            && let Node::Binary(Binary::Sub, u, v) = self.node(a)
            && self.is_uniform(u)
        {
            let sum = self.add(u, b);
            return self.sub(sum, v);
        }
        self.folded(Node::Binary(Binary::Add, a, b))
    }

    pub(super) fn sub(&mut self, a: Id, b: Id) -> Id {
        if self.is(b, 0.0) {
            return a;
        }
        if self.is(a, 0.0) {
            return self.neg(b);
        }
        if let Node::Unary(Unary::Neg, b) = self.node(b) {
            return self.add(a, b);
        }
        if self.is_uniform(b) && !self.is_uniform(a) {
            let negated = self.neg(b);
            return self.add(a, negated);
        }
        if let Node::Binary(Binary::Mul, v, u) = self.node(b)
            && self.is_uniform(u)
            && !self.is_uniform(v)
        {
            let negated = self.neg(b);
            return self.add(a, negated);
        }
        self.folded(Node::Binary(Binary::Sub, a, b))
    }

    pub(super) fn neg(&mut self, a: Id) -> Id {
        match self.node(a) {
            Node::Unary(Unary::Neg, inner) => inner,
            Node::Binary(Binary::Sub, left, right) => self.sub(right, left),
            Node::Binary(Binary::Add, v, u) if self.is_uniform(u) && !self.is_uniform(v) => {
                let negated = self.neg(u);
                self.sub(negated, v)
            }
            Node::Binary(Binary::Mul, v, u) if self.is_uniform(u) && !self.is_uniform(v) => {
                let negated = self.neg(u);
                self.mul(v, negated)
            }
            _ => self.folded(Node::Unary(Unary::Neg, a)),
        }
    }

    pub(super) fn mul(&mut self, a: Id, b: Id) -> Id {
        let (a, b) = self.ordered(a, b);
        if self.zero_annihilates && (self.is(a, 0.0) || self.is(b, 0.0)) {
            return self.constant(0.0);
        }
        for (one, other) in [(b, a), (a, b)] {
            if self.is(one, 1.0) {
                return other;
            }
            if self.is(one, -1.0) {
                return self.neg(other);
            }
        }
        // (v · u) · w = v · (u · w) for uniform u and w.
        if self.is_uniform(b)
            && let Node::Binary(Binary::Mul, v, u) = self.node(a)
            && self.is_uniform(u)
            && !self.is_uniform(v)
        {
            let product = self.mul(u, b);
            return self.mul(v, product);
        }
        match (self.node(a), self.node(b)) {
            (Node::Unary(Unary::Neg, a), _) => {
                let product = self.mul(a, b);
                return self.neg(product);
            }
            (_, Node::Unary(Unary::Neg, b)) if !self.is_uniform(b) || self.is_uniform(a) => {
                let product = self.mul(a, b);
                return self.neg(product);
            }
            _ => {}
        }
        let as_power = |id: Id| match self.node(id) {
            Node::Power(base, n) if n > 0 => (base, n),
            _ => (id, 1),
        };
        let ((p, m), (q, n)) = (as_power(a), as_power(b));
        if p == q
            && let Some(sum) = m.checked_add(n)
        {
            return self.power(p, sum);
        }
        self.folded(Node::Binary(Binary::Mul, a, b))
    }

    pub(super) fn div(&mut self, a: Id, b: Id) -> Id {
        if self.is(b, 1.0) {
            return a;
        }
        if self.zero_annihilates && self.is(a, 0.0) {
            return a;
        }
        if self.is(a, 1.0) {
            return self.power(b, -1);
        }
        if self.is_uniform(b) && !self.is_uniform(a) {
            let reciprocal = self.power(b, -1);
            return self.mul(a, reciprocal);
        }
        self.folded(Node::Binary(Binary::Div, a, b))
    }

    /// a^n for an integer n.
    pub(super) fn power(&mut self, a: Id, n: i32) -> Id {
        match n {
            0 => return self.constant(1.0),
            1 => return a,
            _ => {}
        }
        match self.node(a) {
            Node::Power(inner, m) => {
                if let Some(product) = m.checked_mul(n) {
                    return self.power(inner, product);
                }
            }
            Node::Unary(Unary::Abs, inner) if n % 2 == 0 => return self.power(inner, n),
            Node::Unary(Unary::Neg, inner) => {
                let result = self.power(inner, n);
                return if n % 2 == 0 { result } else { self.neg(result) };
            }
            _ => {}
        }
        self.folded(Node::Power(a, n))
    }

    /// a^b for any exponent. Integer and half-integer constants become products and square roots.
    pub(super) fn pow(&mut self, a: Id, b: Id) -> Id {
        if self.is(a, core::f64::consts::E) {
            return self.unary(Unary::Exp, b);
        }
        if let Some(exponent) = self.as_constant(b) {
            if exponent == libm::trunc(exponent) && exponent.abs() <= f64::from(i32::MAX) {
                #[expect(clippy::cast_possible_truncation, reason = "an integer within the range")]
                return self.power(a, exponent as i32);
            }
            let twice = 2.0 * exponent;
            if twice == libm::trunc(twice) && twice.abs() <= f64::from(i32::MAX) {
                let root = self.unary(Unary::Sqrt, a);
                #[expect(clippy::cast_possible_truncation, reason = "an integer within the range")]
                return self.power(root, twice as i32);
            }
            // (u⁴)^¼ is |u|.
            if let Node::Power(u, n) = self.node(a)
                && n % 2 == 0
                && f64::from(n) * exponent == 1.0
            {
                return self.unary(Unary::Abs, u);
            }
        }
        self.folded(Node::Binary(Binary::Pow, a, b))
    }

    pub(super) fn unary(&mut self, operation: Unary, a: Id) -> Id {
        match (operation, self.node(a)) {
            (Unary::Neg, _) => self.neg(a),
            (Unary::Abs, Node::Unary(Unary::Abs, _)) => a,
            (Unary::Abs, Node::Unary(Unary::Neg, inner)) => self.unary(Unary::Abs, inner),
            // √(u²) has a kink at u = 0, which is seen in |u|.
            (Unary::Sqrt, Node::Power(u, n)) if n % 2 == 0 => {
                let size = self.unary(Unary::Abs, u);
                self.power(size, n / 2)
            }
            _ => self.folded(Node::Unary(operation, a)),
        }
    }

    pub(super) fn binary(&mut self, operation: Binary, a: Id, b: Id) -> Id {
        match operation {
            Binary::Add => self.add(a, b),
            Binary::Sub => self.sub(a, b),
            Binary::Mul => self.mul(a, b),
            Binary::Div => self.div(a, b),
            Binary::Pow => self.pow(a, b),
            Binary::Min | Binary::Max | Binary::Atan2 => self.folded(Node::Binary(operation, a, b)),
        }
    }

    pub(super) fn smin(&mut self, blend: Blend, a: Id, b: Id, k: Id) -> Id {
        if self.as_constant(k).is_some_and(|k| k <= MIN_BLEND_WIDTH) {
            return self.binary(Binary::Min, a, b);
        }
        self.folded(Node::Smin(blend, a, b, k))
    }

    /// The width of the blend of a smooth minimum, which is no smaller than [`MIN_BLEND_WIDTH`],
    /// and the difference of its operands over that width, clamped to −1 … 1.
    pub(super) fn blend(&mut self, a: Id, b: Id, k: Id) -> (Id, Id) {
        let least = self.constant(MIN_BLEND_WIDTH);
        let width = self.binary(Binary::Max, k, least);
        let difference = self.sub(a, b);
        let ratio = self.div(difference, width);
        let (one, minus_one) = (self.constant(1.0), self.constant(-1.0));
        let below = self.binary(Binary::Min, ratio, one);
        (width, self.binary(Binary::Max, below, minus_one))
    }

    /// The node that is `value` where a ≤ b, or where a > b unless `at_most`, and 0 elsewhere.
    pub(super) fn when(&mut self, at_most: bool, a: Id, b: Id, value: Id) -> Id {
        if self.is(value, 0.0) { value } else { self.folded(Node::If(at_most, a, b, value)) }
    }

    /// The node that is `u` where a ≤ b and `v` elsewhere. If it is a minimum, a maximum or an
    /// absolute value it becomes that node: those are continuous.
    pub(super) fn select(&mut self, a: Id, b: Id, u: Id, v: Id) -> Id {
        if u == v {
            return u;
        }
        if let (Some(a), Some(b)) = (self.as_constant(a), self.as_constant(b)) {
            return if a <= b { u } else { v };
        }
        if [u, v] == [a, b] {
            return self.binary(Binary::Min, a, b);
        }
        if [u, v] == [b, a] {
            return self.binary(Binary::Max, a, b);
        }
        let difference = self.sub(b, a);
        let opposite = self.neg(difference);
        if [u, v] == [difference, opposite] {
            return self.unary(Unary::Abs, difference);
        }
        if [u, v] == [opposite, difference] {
            let size = self.unary(Unary::Abs, difference);
            return self.neg(size);
        }
        let joins = self.is_joined(a, b, u, v);
        self.folded(Node::Select(joins, a, b, u, v))
    }

    /// Whether two values are the same node once `a` and `b` are one: u and v of a choice are then
    /// equal on its tie a = b.
    fn is_joined(&self, a: Id, b: Id, u: Id, v: Id) -> bool {
        let (gone, kept) = if self.is_uniform(a) { (b, a) } else { (a, b) };
        let mut tied = self.clone();
        let mut map: Vec<Id> = (0..self.len() as Id).collect();
        map[gone as usize] = kept;
        for id in self.needed_by(&[u, v]).into_iter().filter(|&id| id != gone) {
            let node = self.node(id).mapped(|operand| map[operand as usize]);
            map[id as usize] = match node {
                _ if node == self.node(id) => id,
                // Inner choices are not simplified again.
                Node::Select(..) => tied.intern(node),
                _ => tied.built(node),
            };
        }
        map[u as usize] == map[v as usize]
    }
}
