//! What is sent is what is shown, whatever comes in between.

use super::bytes::BEFORE_JOINTS;
use super::*;
use proptest::prelude::*;

const NOW: i64 = 1_700_000_000_000_000_000;

fn seen(joints: &[f32]) -> ArmView {
    ArmView {
        joints: Joints::from_slice(joints).unwrap(),
        tip: [0.3, -0.1, 0.0],
        force: [1.0, -8.0, 0.5],
        contact: ContactView {
            in_contact: true,
            valid: true,
            edge: 2,
            forces: [8.0, 1.0],
            ..ContactView::default()
        },
    }
}

/// Of one, two, seven and eight joints; by a clock that is 3 s ahead.
#[test]
fn what_is_sent_is_shown_with_its_time_by_the_clock_of_who_sees_it() {
    let joints = [0.1, -0.2, 0.3, -0.4, 0.5, -0.6, 0.7, -0.8];
    for count in [1, 2, 7, 8] {
        let (view, ahead) = (seen(&joints[..count]), 3_000_000_000);
        let view = View::Arm(view);
        let bytes = encode(&view, 5, NOW + ahead);
        assert_eq!(bytes.len(), 43 + 4 * count);
        let sent = decode(&bytes, NOW + 40_000_000, ahead).unwrap();
        assert_eq!((sent.number, sent.sent_ns, sent.view), (5, NOW, view));
        for length in [0, 9, BEFORE_JOINTS - 1, BEFORE_JOINTS, bytes.len() - 1] {
            let error = decode(&bytes[..length], NOW, 0).unwrap_err();
            assert!(matches!(error, ViewError::Length { .. }), "{length}");
        }
    }
}

#[test]
fn what_is_no_number_or_out_of_range_is_named() {
    let good = seen(&[0.1, 0.2]);
    type Spoil = fn(&mut ArmView);
    let spoilt: [(&str, Spoil); 4] = [
        ("position of the tip", |own| own.tip[1] = 11.0),
        ("force", |own| own.force[2] = f32::NAN),
        ("force of the contact", |own| own.contact.forces[0] = 2e4),
        ("joint position", |own| own.joints[1] = f32::INFINITY),
    ];
    for (named, spoil) in spoilt {
        let mut view = good;
        spoil(&mut view);
        let error = decode(&encode(&View::Arm(view), 0, NOW), NOW, 0).unwrap_err();
        let ViewError::Value { field, .. } = error else {
            panic!("{error}");
        };
        assert_eq!(field, named);
    }
}

#[test]
fn why_the_arm_holds_is_told_as_it_is_cut_where_there_is_no_room_and_never_what_steers_a_terminal()
{
    let long = "ü".repeat(60);
    for (said, told) in [
        ("", ""),
        ("pause was asked for", "pause was asked for"),
        (&long, &long[..96]),
    ] {
        let view = View::Reason(Reason::new(OperatingState::Paused, said));
        let bytes = encode(&view, 1, NOW);
        let View::Reason(reason) = decode(&bytes, NOW, 0).unwrap().view else {
            panic!("{said}");
        };
        assert_eq!(
            (reason.state, reason.text()),
            (OperatingState::Paused, told)
        );
        let escape = encode(
            &View::Reason(Reason::new(OperatingState::Paused, "\u{1b}[2J")),
            1,
            NOW,
        );
        assert_eq!(decode(&escape, NOW, 0), Err(ViewError::Text));
        let mut unknown = bytes.to_vec();
        unknown[9] = 9;
        assert_eq!(decode(&unknown, NOW, 0), Err(ViewError::Text));
        unknown.resize(LONGEST_VIEW + 1, b'x');
        assert!(matches!(
            decode(&unknown, NOW, 0),
            Err(ViewError::Length { .. })
        ));
    }
}

fn shows_arm(bytes: &ViewBytes) -> bool {
    matches!(decode(bytes, NOW, 0).unwrap().view, View::Arm(_))
}

#[test]
fn one_is_due_every_40_ms_a_reason_at_once_and_what_was_overtaken_is_not_shown() {
    let (mut sender, mut receiver) = (ViewSender::default(), ViewReceiver::default());
    let at = |tick: i64| NOW + tick * 1_000_000;
    let arm = || Some(seen(&[0.1]));
    let sent: Vec<_> = (0..1000)
        .filter_map(|tick| sender.step(at(tick), None, arm))
        .collect();
    assert_eq!(sent.len(), 25);
    assert!(sent.iter().all(shows_arm));
    let mut shown = |number: usize| receiver.arrived(&sent[number], at(1000), 0).unwrap();
    assert_eq!(shown(3).map(|own| own.number), Some(3));
    assert_eq!(shown(2), None);
    assert_eq!(shown(3), None);
    assert_eq!(shown(4).map(|own| own.number), Some(4));
    receiver.restart();
    assert!(receiver.arrived(&sent[0], at(1000), 0).unwrap().is_some());

    // Nothing is counted while there is nothing to show, and a clock that jumps back stops nothing.
    assert_eq!(sender.step(at(2000), None, || None), None);
    assert!(sender.step(at(-9000), None, arm).is_some());
    let why = Some(Reason::new(OperatingState::Paused, "pause was asked for"));
    let sent: Vec<_> = (-8999..-7999)
        .filter_map(|tick| sender.step(at(tick), why, arm))
        .collect();
    assert!(!shows_arm(&sent[0]), "the reason waits");
    let reasons = sent.iter().filter(|own| !shows_arm(own)).count();
    assert_eq!((sent.len(), reasons), (25, 4));
}

proptest! {
    #[test]
    fn garbage_never_panics_and_what_is_decoded_is_finite(
        mut bytes in proptest::collection::vec(any::<u8>(), 0..120),
        joints in 0..16u8,
        reason: bool,
        fits: bool,
        now: i64,
        ahead: i64,
    ) {
        if fits {
            bytes.resize(BEFORE_JOINTS + 4 * usize::from(joints), 0);
            bytes[8] = joints;
        } else if reason && bytes.len() > 9 {
            (bytes[8], bytes[9]) = (0, joints % 5);
        }
        if let Ok(sent) = decode(&bytes, now, ahead) {
            if let View::Arm(ArmView { joints, tip, force, contact }) = sent.view {
                let all = joints.iter().chain(&tip).chain(&force).chain(&contact.forces);
                prop_assert!(all.copied().all(f32::is_finite));
            }
            prop_assert_eq!(encode(&sent.view, sent.number, now).len(), bytes.len());
        }
    }
}
