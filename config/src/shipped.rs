//! The configuration that comes with the binary, so that it runs from any
//! folder. A file on disk of the same name wins.

/// Path below `config/` and text of every shipped file.
pub const FILES: &[(&str, &str)] = &[
    ("arms/rokviss.toml", include_str!("../arms/rokviss.toml")),
    ("arms/panda.toml", include_str!("../arms/panda.toml")),
    ("arms/panda.urdf", include_str!("../arms/panda.urdf")),
    ("arms/ur5.toml", include_str!("../arms/ur5.toml")),
    ("arms/ur5.urdf", include_str!("../arms/ur5.urdf")),
    ("arms/xarm7.toml", include_str!("../arms/xarm7.toml")),
    ("arms/xarm7.urdf", include_str!("../arms/xarm7.urdf")),
    ("arms/so101.toml", include_str!("../arms/so101.toml")),
    ("arms/so101.urdf", include_str!("../arms/so101.urdf")),
    ("arms/kinova.toml", include_str!("../arms/kinova.toml")),
    ("arms/kinova.urdf", include_str!("../arms/kinova.urdf")),
    ("arms/z1.toml", include_str!("../arms/z1.toml")),
    (
        "arms/LICENSE-BSD-3-Clause",
        include_str!("../arms/LICENSE-BSD-3-Clause"),
    ),
    (
        "experiments/mission.toml",
        include_str!("../experiments/mission.toml"),
    ),
    (
        "experiments/contact.toml",
        include_str!("../experiments/contact.toml"),
    ),
    ("links/direct.toml", include_str!("../links/direct.toml")),
    (
        "links/rokviss_20ms.toml",
        include_str!("../links/rokviss_20ms.toml"),
    ),
    (
        "links/rokviss_30ms.toml",
        include_str!("../links/rokviss_30ms.toml"),
    ),
    (
        "links/kontur_2.toml",
        include_str!("../links/kontur_2.toml"),
    ),
    (
        "links/relay_600ms.toml",
        include_str!("../links/relay_600ms.toml"),
    ),
    (
        "links/ku_band_800ms.toml",
        include_str!("../links/ku_band_800ms.toml"),
    ),
    (
        "scenarios/rokviss.toml",
        include_str!("../scenarios/rokviss.toml"),
    ),
    (
        "scenarios/kontur_2.toml",
        include_str!("../scenarios/kontur_2.toml"),
    ),
    (
        "scenarios/relay.toml",
        include_str!("../scenarios/relay.toml"),
    ),
    (
        "scenarios/ku_band.toml",
        include_str!("../scenarios/ku_band.toml"),
    ),
    (
        "scenarios/panda.toml",
        include_str!("../scenarios/panda.toml"),
    ),
    ("scenarios/ur5.toml", include_str!("../scenarios/ur5.toml")),
    (
        "scenarios/xarm7.toml",
        include_str!("../scenarios/xarm7.toml"),
    ),
    (
        "scenarios/delay_sweep.toml",
        include_str!("../scenarios/delay_sweep.toml"),
    ),
    (
        "scenarios/operator.toml",
        include_str!("../scenarios/operator.toml"),
    ),
];

/// Text of the shipped file at `path` below `config/`.
pub fn text(path: &str) -> Option<&'static str> {
    FILES
        .iter()
        .find(|(name, _)| *name == path)
        .map(|(_, text)| *text)
}

/// Files that are of another kind than the others in their folder, by that kind.
const OF_OTHER_KINDS: [(&str, &str); 2] = [
    ("scenarios/delay_sweep.toml", "sweep"),
    ("experiments/contact.toml", "experiment of the lab"),
];

/// Names of the shipped files of that kind in `folder`, without `.toml`.
pub fn names(kind: &str, folder: &str) -> Vec<&'static str> {
    let only = OF_OTHER_KINDS.iter().any(|(_, other)| *other == kind);
    let is_of_kind = |path: &str| match OF_OTHER_KINDS.iter().find(|(own, _)| *own == path) {
        Some((_, other)) => *other == kind,
        None => !only,
    };
    let paths = FILES.iter().map(|(path, _)| *path);
    let names = paths.filter(|path| is_of_kind(path)).filter_map(|path| {
        path.strip_prefix(folder)?
            .strip_prefix('/')?
            .strip_suffix(".toml")
    });
    names.collect()
}
