//! What the files of the truth begin with.

use super::paper::Paper;
use artifact::{
    HeadPoseHeader, LargeScale, MarkerHeader, Profile, Rate, SectionsHeader, SequenceForm, Space, SyncHeader,
    TakeRef, Tracks2dHeader, Unit, ValleysHeader, Wrinkle, Wrinkles2dHeader,
};
use virtual_rig::clock::Schedule;
use virtual_rig::take::{Role, Studio};

/// What the files of the truth begin with.
pub(super) struct Headers<'a> {
    studio: &'a Studio,
    paper: &'a Paper,
    rate: Option<Rate>,
    take: Option<TakeRef>,
}

impl<'a> Headers<'a> {
    pub(super) fn new(studio: &'a Studio, paper: &'a Paper) -> Self {
        let rate = Some(studio.scenario().extent.rate);
        Self { studio, paper, rate, take: Some(paper.take.clone()) }
    }

    /// Ids of the cameras that film this.
    pub(super) fn cameras(&self, role: Role) -> Vec<String> {
        let stations = self.studio.stations().iter().filter(|(_, station)| station.role == role);
        stations.map(|(id, _)| id.clone()).collect()
    }

    fn wrinkles(&self) -> Vec<Wrinkle> {
        let lines = self.studio.wrinkles().lines();
        lines.map(|line| Wrinkle { id: line.id.clone(), paint: Some(line.paint.clone()) }).collect()
    }

    pub(super) fn sync(&self, schedule: &Schedule) -> SyncHeader {
        let stations = self.studio.stations();
        SyncHeader {
            rate: self.studio.scenario().extent.rate,
            clock: self.paper.clock,
            cameras: schedule
                .cameras
                .iter()
                .map(|(id, _)| (id.clone(), self.studio.sync_of(id, &stations[id])))
                .collect(),
            take: self.take.clone(),
        }
    }

    pub(super) fn tracks(&self) -> Tracks2dHeader {
        let (cameras, markers) = (self.cameras(Role::Mocap), self.studio.marker_names());
        Tracks2dHeader { cameras, markers, rate: self.rate, take: self.take.clone() }
    }

    pub(super) fn markers(&self) -> MarkerHeader {
        let markers = self.studio.marker_names();
        MarkerHeader { unit: Unit::Mm, rate: self.rate, markers, take: self.take.clone() }
    }

    pub(super) fn pose(&self) -> HeadPoseHeader {
        HeadPoseHeader {
            rate: self.rate,
            reference_frame: self.studio.scenario().extent.first_frame,
            markers: self.studio.head_markers(),
            take: self.take.clone(),
        }
    }

    pub(super) fn valleys(&self) -> ValleysHeader {
        ValleysHeader {
            mesh: self.paper.scan.clone(),
            wrinkles: self.wrinkles(),
            rate: self.rate,
            take: self.take.clone(),
            space: Space::Face,
        }
    }

    pub(super) fn curves(&self) -> Wrinkles2dHeader {
        let (cameras, wrinkles) = (self.cameras(Role::Wrinkle), self.wrinkles());
        Wrinkles2dHeader { cameras, wrinkles, rate: self.rate, take: self.take.clone() }
    }

    pub(super) fn sections(&self) -> SectionsHeader {
        SectionsHeader {
            cameras: self.cameras(Role::Wrinkle),
            wrinkles: self.wrinkles(),
            profile: Profile::Rounded,
            rate: self.rate,
            take: self.take.clone(),
        }
    }

    pub(super) fn index(&self, frames: Vec<i64>) -> LargeScale {
        LargeScale {
            mesh: self.paper.scan.clone(),
            cache: String::new(),
            form: SequenceForm::Pc2,
            rate: self.rate,
            frames,
            take: self.take.clone(),
        }
    }
}
