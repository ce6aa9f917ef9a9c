//! The bench of a tip on an edge.

use ferntast_benches::{
    bench::{BenchError, LOG_PERIOD},
    contact_bench::{
        ContactBench, ContactConfig, ContactRecording, ContactSession, HiddenEffect, Motion,
        TrueParameter,
    },
};
use ferntast_bus::Bus;
use ferntast_identification::{Dataset, JointType, ModelSpec, RecordedSession};
use ferntast_msgs::{
    sample::{Frame, PoseSample, TemperatureSample, WrenchSample},
    topics,
};

use super::{TestBench, WriteError, model_of, quoted, stamp, temperature_topic};

/// Session `number` of a recording.
fn session(own: &ContactSession, number: usize) -> RecordedSession {
    RecordedSession {
        name: format!("session {number}"),
        start: own.start,
        period: LOG_PERIOD,
        position: own.place.clone(),
        motor_torque: own.tangential.clone(),
        normal_force: Some(own.normal.clone()),
        temperature: Some(own.temperature.clone()),
        ..RecordedSession::default()
    }
}

impl TestBench for HiddenEffect {
    type Motion = Motion;
    type Bench = ContactBench;
    type Recording = ContactRecording;

    // What shows from date to date needs more of them than a joint's riddles have.
    const SESSIONS: usize = 8;

    fn bench(config: &ContactConfig) -> Result<ContactBench, BenchError> {
        ContactBench::new(config)
    }

    fn record(bench: &ContactBench) -> Result<ContactRecording, BenchError> {
        Ok(bench.record())
    }

    fn follow_up(
        bench: &ContactBench,
        recording: &ContactRecording,
        motion: Motion,
        sessions: usize,
    ) -> Result<Vec<RecordedSession>, BenchError> {
        let first = recording.sessions.len() + 1;
        let more = bench.follow_up(recording, motion, sessions);
        let more = more.iter().zip(first..);
        Ok(more.map(|(own, number)| session(own, number)).collect())
    }

    fn without_hidden(recording: &ContactRecording) -> ContactRecording {
        recording.without_hidden()
    }

    fn dataset(recording: &ContactRecording) -> Dataset {
        let sessions = recording.sessions.iter().zip(1..);
        Dataset {
            sessions: sessions.map(|(own, number)| session(own, number)).collect(),
            joint: JointType::Contact,
            ..Dataset::default()
        }
    }

    fn model(recording: &ContactRecording) -> ModelSpec {
        model_of(0.0, None, &recording.believed)
    }

    fn truth(recording: &ContactRecording) -> &[TrueParameter] {
        &recording.truth
    }

    fn reference_rms(recording: &ContactRecording) -> f64 {
        recording.reference_rms()
    }

    fn publish(recording: &ContactRecording, bus: &Bus) -> Result<(), WriteError> {
        let mut force = bus.publisher(topics::FOLLOWER_CONTACT_CF)?;
        let mut tip = bus.publisher(topics::FOLLOWER_MEASURED_CP)?;
        let mut temperature = bus.publisher(temperature_topic()?)?;
        for session in &recording.sessions {
            for (index, time) in session.time.iter().enumerate() {
                let stamp = stamp(session.start, *time);
                // The force on the tip: friction pulls it back.
                let on_tip = [-session.tangential[index], 0.0, session.normal[index]];
                let sample = WrenchSample::force(stamp, Frame::CONTACT, on_tip);
                force.publish(stamp, &sample)?;
                // The edge lies along x.
                let place = [session.place[index], 0.0, 0.0];
                tip.publish(stamp, &PoseSample::at(stamp, Frame::FOLLOWER_BASE, place))?;
                let warm = TemperatureSample::new(stamp, session.temperature[index]);
                temperature.publish(stamp, &warm)?;
            }
        }
        Ok(())
    }

    fn experiment(recording: &ContactRecording) -> Result<String, WriteError> {
        Ok(format!(
            "# A tip on an edge, {} sessions. What is missing from this model?\n\
             recording = \"recording\"\n\n\
             [contact]\n\n\
             [signals]\n\
             tangential_force = \"{force}.wrench.force.x.@negative\" # N\n\
             normal_force = \"{force}.wrench.force.z\" # N\n\
             position = \"{}.pose.position.x\" # m\n\
             temperature = \"{}.temperature\" # degC\n\n\
             [model]\n\
             effects = [{}]\n",
            recording.sessions.len(),
            topics::FOLLOWER_MEASURED_CP.name,
            temperature_topic()?.name,
            quoted(&recording.believed),
            force = topics::FOLLOWER_CONTACT_CF.name,
        ))
    }
}
