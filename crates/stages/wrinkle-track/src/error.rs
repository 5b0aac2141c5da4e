//! What can go wrong.

/// Wrinkles could not be learnt or followed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A parameter is out of its range.
    #[error("--{name} is {value}: {allowed}")]
    Parameter {
        /// Its option.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What would do.
        allowed: &'static str,
    },
    /// Values do not make a picture.
    #[error("{values} values make no picture of {} × {} px", size[0], size[1])]
    Pixels {
        /// Width, height.
        size: [usize; 2],
        /// Number of values.
        values: usize,
    },
    /// The mask marks nothing.
    #[error(
        "nothing is painted in it\n  to do: paint what is wrinkle paint, in a colour per paint, on black or transparent ground"
    )]
    EmptyMask,
    /// The mask marks everything, or so little that nothing can be learnt.
    #[error(
        "{painted} of {all} px are marked as {paint}; both paint and bare skin are needed to learn from\n  to do: mark the paint, and nothing else"
    )]
    FewPixels {
        /// The paint.
        paint: String,
        /// Marked pixels.
        painted: usize,
        /// All pixels.
        all: usize,
    },
    /// What is marked, or lies around it, is too bright or too dark to be told from anything.
    #[error(
        "of {all} px that are marked as {paint} or lie around them, {clipped} are black or saturated; nothing can be learnt from those\n  to do: expose so that neither paint nor skin is clipped in any channel"
    )]
    Clipped {
        /// The paint.
        paint: String,
        /// Clipped pixels.
        clipped: usize,
        /// All of them.
        all: usize,
    },
    /// The mask has another size than the image.
    #[error("has {} × {} px, but the image {} × {}\n  to do: paint over the image itself, without scaling it", mask[0], mask[1], image[0], image[1])]
    MaskSize {
        /// Width, height of the mask.
        mask: [usize; 2],
        /// Those of the image.
        image: [usize; 2],
    },
    /// The mask's colours run into each other.
    #[error(
        "{blends} of {painted} marked px have colours of their own, as soft brushes leave them\n  to do: paint with a hard brush, in one colour per paint, and save as PNG"
    )]
    Blends {
        /// Pixels that no common colour has.
        blends: usize,
        /// All marked pixels.
        painted: usize,
    },
    /// All samples are paint, or none is.
    #[error("all training pixels are of one kind")]
    OneClass,
    /// The optimum was not reached.
    #[error("the classifier does not converge\n  to do: give a smaller --c")]
    Unsolved,
    /// A paint cannot be told from what surrounds it.
    #[error("the paint {paint} cannot be told from the rest of the image: of pixels that were not learnt from, {:.1} % are told rightly (50 % is chance, {:.0} % is asked for)\n  to do: check that the mask belongs to this image; paint in a colour that skin has not", 100.0 * score, 100.0 * least)]
    Indistinct {
        /// The paint.
        paint: String,
        /// Share of held-out pixels that are told rightly.
        score: f64,
        /// The share that would do.
        least: f64,
    },
    /// More paints than a table can tell apart.
    #[error("{0} paints are too many; up to 64 can be told apart")]
    ManyPaints(usize),
}
