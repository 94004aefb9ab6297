//! Any bytes are a snapshot or a checkpoint of this build, or are refused, whatever lies behind a good seal.
#![no_main]

use std::sync::LazyLock;

use chaindrive::{Checkpoint, Run, Scene, Simulation, Snapshot};

/// A ring at its start.
static RING: LazyLock<Simulation> = LazyLock::new(|| {
    let scene = Scene::preset("spinning_ring").expect("a preset");
    let drive = scene.drive().expect("a drive");
    Simulation::start(&drive, &Run::default()).expect("a run")
});

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = Checkpoint::from_bytes(bytes);
    let _ = Snapshot::from_bytes(bytes);
    // Damaged behind its seal, which is made good: what lies there is read.
    let whole = RING.snapshot().to_bytes();
    let end = whole.iter().position(|byte| *byte == b'\n').expect("a first line");
    let (line, mut content) = (&whole[..end], whole[end + 1..].to_vec());
    for change in bytes.chunks_exact(5) {
        let at = u32::from_le_bytes([change[0], change[1], change[2], change[3]]) as usize;
        let place = at % content.len();
        content[place] ^= change[4];
    }
    let line = str::from_utf8(line).expect("text");
    let (before, _) = line.rsplit_once(' ').expect("a checksum at the end");
    let mut damaged = format!("{before} {:08x}\n", crc32fast::hash(&content)).into_bytes();
    damaged.extend(content);
    if let Ok(snapshot) = Snapshot::from_bytes(&damaged) {
        let _ = RING.clone().restore(&snapshot);
    }
});
