//! What pages there are, what each needs, and what comes after it.

/// Where a file is looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Place {
    /// In the take's folder: what people bring.
    Take,
    /// In the folder of a run: what stages make.
    Run,
}

/// A file or folder that a page needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Need {
    /// Where it may be; the first one that is there counts.
    pub places: &'static [(Place, &'static str)],
    /// What it is.
    pub what: &'static str,
    /// Who makes it.
    pub made_by: &'static str,
    /// Whether the page can do something without it.
    pub is_optional: bool,
}

/// A page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Page {
    /// Its id, in addresses.
    pub id: &'static str,
    /// Its name.
    pub title: &'static str,
    /// What a person does there.
    pub does: &'static str,
    /// What it needs.
    pub needs: &'static [Need],
    /// What it writes, in the take's folder; `…` where there is one per camera or photograph.
    pub writes: &'static str,
    /// What to run next.
    pub next: &'static str,
}

/// All pages, in the order in which a take needs them.
#[must_use]
pub fn pages() -> &'static [Page] {
    &PAGES
}

/// What a page cannot do without.
const fn need(places: &'static [(Place, &'static str)], what: &'static str, made_by: &'static str) -> Need {
    Need { places, what, made_by, is_optional: false }
}

impl Need {
    const fn optional(self) -> Self {
        Self { is_optional: true, ..self }
    }
}

/// Calibrated cameras.
pub const CAMERAS: &[(Place, &str)] = &[(Place::Take, "cameras.json"), (Place::Run, "capture/cameras.json")];
/// The scan.
pub const SCAN: &[(Place, &str)] = &[(Place::Take, "scan.obj"), (Place::Take, "scan.ply")];
/// The markers in 3D, in the space of the head.
pub const HEAD: &[(Place, &str)] = &[(Place::Run, "capture/head.jsonl")];
/// The images by frame; their time base stands beside them.
pub const IMAGES: &[(Place, &str)] = &[(Place::Run, "capture/sync/frames.json")];

const TAKE: &str = "just take TAKE";
const NEED_IMAGES: Need = need(IMAGES, "the images by frame", TAKE);
const NEED_SCAN: Need =
    need(SCAN, "the face at rest, mouth and eyes cut open", "your scanner, then mesh-clip");
const NEED_PHOTOGRAPHS: Need = need(
    &[(Place::Take, "photographs")],
    "photographs of the face, at rest and with an expression",
    "your camera",
);

const PAGES: [Page; 6] = [
    Page {
        id: "labels",
        title: "Markers",
        does: "Say which dot is which marker, in one frame of each camera",
        needs: &[
            NEED_IMAGES,
            need(
                CAMERAS,
                "calibrated cameras: lines on which a marker must lie",
                "calibrate, or just take TAKE",
            )
            .optional(),
        ],
        writes: "labels.json",
        next: TAKE,
    },
    Page {
        id: "picks",
        title: "Correspondences",
        does: "Say where each marker sits on the scan",
        needs: &[
            NEED_SCAN,
            need(&[(Place::Take, "labels.json")], "the names of the markers", "the page Markers").optional(),
            need(HEAD, "markers in 3D, to see what the warp does", TAKE).optional(),
        ],
        writes: "picks.csv",
        next: TAKE,
    },
    Page {
        id: "paint",
        title: "Paint",
        does: "Mark the paint of the wrinkles in one image of each camera",
        needs: &[NEED_IMAGES],
        writes: "paint-mask/….png",
        next: TAKE,
    },
    Page {
        id: "landmarks",
        title: "Landmarks",
        does: "Say which place of one photograph is which place of the other",
        needs: &[NEED_PHOTOGRAPHS],
        writes: "photographs/….landmarks.json",
        next: "normalmap-acquire acquire",
    },
    Page {
        id: "regions",
        title: "Regions",
        does: "Paint where something holds: on photographs, over texture coordinates, on the scan",
        needs: &[NEED_SCAN.optional(), NEED_PHOTOGRAPHS.optional()],
        writes: "masks/….png, regions/….json",
        next: "mesh-clip, wrinkle-removal, linear-shell or normalmap-acquire with what was painted",
    },
    Page {
        id: "wrinkles",
        title: "Wrinkles",
        does: "Draw wrinkles, make them deeper or wider, take them away, and see what becomes of the face",
        needs: &[
            NEED_IMAGES,
            need(&[(Place::Run, "wrinkles/measured.jsonl")], "measured wrinkles", TAKE),
            need(&[(Place::Run, "wrinkles/wrinkles.jsonl")], "their valley curves", TAKE),
            need(&[(Place::Run, "medium-scale/wrinkled.json")], "the wrinkled face", TAKE).optional(),
        ],
        writes: "wrinkle-edits.txt",
        next: TAKE,
    },
];
