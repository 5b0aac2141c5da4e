//! Disjoint sets.

/// Disjoint sets of the numbers 0 to n − 1, whose representative is their lowest member: the order of joining says nothing.
#[derive(Debug, Clone)]
pub struct Forest(Vec<u32>);

impl Forest {
    /// Every number by itself.
    #[must_use]
    pub fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    /// The lowest member of a number's set.
    ///
    /// # Panics
    /// If there is no such number, as all methods here do.
    pub fn root(&mut self, of: u32) -> u32 {
        let mut at = of;
        while self.0[at as usize] != at {
            self.0[at as usize] = self.0[self.0[at as usize] as usize];
            at = self.0[at as usize];
        }
        at
    }

    /// Makes the sets of two numbers one.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}
