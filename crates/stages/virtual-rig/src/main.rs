//! `virtual-rig`: arguments → read → call → write.

fn main() {}
