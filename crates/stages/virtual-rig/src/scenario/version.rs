//! Which scenario it is: a name stands for one content, the seed apart.

use super::{Scenario, preset};

/// Ends the name of a scenario that was changed since it got its name.
const CHANGED: char = '+';

impl Scenario {
    /// The same for another person, performance, paint and noise; the head's motion follows. Its own seed changes nothing.
    #[must_use]
    pub fn with_seed(self, seed: u64) -> Self {
        match seed == self.seed {
            true => self,
            false => {
                let head = crate::act::HeadMotion { seed, ..self.head };
                Self { seed, head, ..self }
            }
        }
    }

    /// Ends the name with a `+` if this is no longer what was `read`, or bears a published name without being that
    /// scenario. The seed alone is no change: names of takes hold it.
    pub fn mark_changes(&mut self, read: &Self) {
        let is = |named: Self| named.with_seed(self.seed) == *self;
        let is_itself = preset(&self.name).is_none_or(is) && is(read.clone());
        if !is_itself && !self.name.ends_with(CHANGED) {
            self.name.push(CHANGED);
        }
    }
}
