//! The configuration that comes with the binary, so that it runs from any
//! folder. A file on disk of the same name wins.

/// Path below `config/` and text of every shipped file.
pub const FILES: &[(&str, &str)] = &[
    (
        "arms/rokviss.toml",
        include_str!("../../../config/arms/rokviss.toml"),
    ),
    (
        "arms/panda.toml",
        include_str!("../../../config/arms/panda.toml"),
    ),
    (
        "arms/panda.urdf",
        include_str!("../../../config/arms/panda.urdf"),
    ),
    (
        "experiments/mission.toml",
        include_str!("../../../config/experiments/mission.toml"),
    ),
    (
        "links/direct.toml",
        include_str!("../../../config/links/direct.toml"),
    ),
    (
        "links/rokviss_20ms.toml",
        include_str!("../../../config/links/rokviss_20ms.toml"),
    ),
    (
        "links/rokviss_30ms.toml",
        include_str!("../../../config/links/rokviss_30ms.toml"),
    ),
    (
        "links/kontur_2.toml",
        include_str!("../../../config/links/kontur_2.toml"),
    ),
    (
        "links/relay_600ms.toml",
        include_str!("../../../config/links/relay_600ms.toml"),
    ),
    (
        "links/ku_band_800ms.toml",
        include_str!("../../../config/links/ku_band_800ms.toml"),
    ),
    (
        "scenarios/rokviss.toml",
        include_str!("../../../config/scenarios/rokviss.toml"),
    ),
    (
        "scenarios/kontur_2.toml",
        include_str!("../../../config/scenarios/kontur_2.toml"),
    ),
    (
        "scenarios/relay.toml",
        include_str!("../../../config/scenarios/relay.toml"),
    ),
    (
        "scenarios/ku_band.toml",
        include_str!("../../../config/scenarios/ku_band.toml"),
    ),
    (
        "scenarios/delay_sweep.toml",
        include_str!("../../../config/scenarios/delay_sweep.toml"),
    ),
    (
        "scenarios/operator.toml",
        include_str!("../../../config/scenarios/operator.toml"),
    ),
];

/// Text of the shipped file at `path` below `config/`.
pub fn text(path: &str) -> Option<&'static str> {
    FILES
        .iter()
        .find(|(name, _)| *name == path)
        .map(|(_, text)| *text)
}

/// Names of the shipped files in `folder`, without `.toml`.
pub fn names(folder: &str) -> Vec<&'static str> {
    FILES
        .iter()
        .filter_map(|(name, _)| {
            name.strip_prefix(folder)?
                .strip_prefix('/')?
                .strip_suffix(".toml")
        })
        .collect()
}
