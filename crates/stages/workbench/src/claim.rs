//! Who may write: one page at a time.

/// How long a page may be silent before another one may write, s.
const PATIENCE_S: f64 = 20.0;

/// The page that may write at the moment. Time is told, not asked for.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Claim {
    holder: Option<Holder>,
}

#[derive(Debug, Clone, PartialEq)]
struct Holder {
    page: String,
    heard_s: f64,
}

/// How a page stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// It may write.
    Holds,
    /// Another page does; this one may look.
    Looks,
}

impl Claim {
    /// A page says that it is there: it may write if nobody else has within the last seconds.
    pub fn hear(&mut self, page: &str, now_s: f64) -> Standing {
        match &self.holder {
            Some(holder) if holder.page != page && now_s - holder.heard_s < PATIENCE_S => Standing::Looks,
            _ => self.take(page, now_s),
        }
    }

    /// A person says that this page is the one to write.
    pub fn take(&mut self, page: &str, now_s: f64) -> Standing {
        self.holder = Some(Holder { page: page.to_string(), heard_s: now_s });
        Standing::Holds
    }

    /// A page is closed.
    pub fn leave(&mut self, page: &str) {
        self.holder.take_if(|holder| holder.page == page);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_page_looks_until_the_first_is_gone() {
        let mut claim = Claim::default();
        assert_eq!(claim.hear("a", 0.0), Standing::Holds);
        assert_eq!(claim.hear("b", 5.0), Standing::Looks);
        assert_eq!(claim.hear("a", 10.0), Standing::Holds);
        assert_eq!(claim.hear("b", 29.0), Standing::Looks);
        assert_eq!(claim.hear("b", 30.0), Standing::Holds);
        assert_eq!(claim.hear("a", 31.0), Standing::Looks);
    }

    #[test]
    fn a_page_may_be_taken_over_and_left() {
        let mut claim = Claim::default();
        claim.hear("a", 0.0);
        assert_eq!(claim.take("b", 1.0), Standing::Holds);
        assert_eq!(claim.hear("a", 2.0), Standing::Looks);
        claim.leave("a");
        assert_eq!(claim.hear("a", 3.0), Standing::Looks);
        claim.leave("b");
        assert_eq!(claim.hear("a", 4.0), Standing::Holds);
    }
}
