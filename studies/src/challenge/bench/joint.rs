//! The bench of one joint.

use ferntast_benches::{
    bench::BenchError,
    joint_bench::{
        Bench, BenchConfig, BenchRecording, BenchSession, HiddenEffect, Motion, TrueParameter,
    },
};
use ferntast_bus::Bus;
use ferntast_identification::{Dataset, JointType, ModelSpec, RecordedSession};
use ferntast_msgs::{
    sample::{JointSample, TemperatureSample},
    topics,
};

use super::{TestBench, WriteError, joints, model_of, quoted, stamp, temperature_topic};

/// Session `number` of a recording. Whoever runs it knows whether there are
/// springs to pull.
fn session(own: &BenchSession, number: usize) -> RecordedSession {
    RecordedSession {
        name: format!("session {number}"),
        start: own.start,
        period: own.period,
        position: own.position.clone(),
        motor_torque: own.motor_torque.clone(),
        joint_torque: Some(own.joint_torque.clone()),
        temperature: Some(own.temperature.clone()),
        unloaded: own.motion.is_some_and(|motion| !motion.has_springs()),
        ..RecordedSession::default()
    }
}

impl TestBench for HiddenEffect {
    type Motion = Motion;
    type Bench = Bench;
    type Recording = BenchRecording;

    const SESSIONS: usize = 6;

    fn bench(config: &BenchConfig) -> Result<Bench, BenchError> {
        Bench::new(config)
    }

    fn record(bench: &Bench) -> Result<BenchRecording, BenchError> {
        bench.record()
    }

    fn follow_up(
        bench: &Bench,
        recording: &BenchRecording,
        motion: Motion,
        sessions: usize,
    ) -> Result<Vec<RecordedSession>, BenchError> {
        let first = recording.sessions.len() + 1;
        let more = bench.follow_up(recording, motion, sessions)?;
        let more = more.iter().zip(first..);
        Ok(more.map(|(own, number)| session(own, number)).collect())
    }

    fn without_hidden(recording: &BenchRecording) -> BenchRecording {
        recording.without_hidden()
    }

    fn dataset(recording: &BenchRecording) -> Dataset {
        let sessions = recording.sessions.iter().zip(1..);
        Dataset {
            sessions: sessions.map(|(own, number)| session(own, number)).collect(),
            joint: JointType::Revolute,
            ..Dataset::default()
        }
    }

    fn model(recording: &BenchRecording) -> ModelSpec {
        let believed = &recording.believed;
        model_of(
            believed.inertia,
            Some(believed.gear_ratio),
            &believed.effects,
        )
    }

    fn truth(recording: &BenchRecording) -> &[TrueParameter] {
        &recording.truth
    }

    fn reference_rms(recording: &BenchRecording) -> f64 {
        recording.reference_rms()
    }

    fn publish(recording: &BenchRecording, bus: &Bus) -> Result<(), WriteError> {
        let mut measured = bus.publisher(topics::FOLLOWER_MEASURED_JS)?;
        let mut motor = bus.publisher(topics::FOLLOWER_MOTOR_JS)?;
        let mut temperature = bus.publisher(temperature_topic()?)?;
        for session in &recording.sessions {
            for (index, time) in session.time.iter().enumerate() {
                let stamp = stamp(session.start, *time);
                // The bench has one joint; the other stands still.
                let empty = JointSample::empty(joints(), stamp);
                let sample = empty
                    .with_position([session.position[index]])
                    .with_effort([session.joint_torque[index]]);
                measured.publish(stamp, &sample)?;
                motor.publish(stamp, &empty.with_effort([session.motor_torque[index]]))?;
                let warm = TemperatureSample::new(stamp, session.temperature[index]);
                temperature.publish(stamp, &warm)?;
            }
        }
        Ok(())
    }

    fn experiment(recording: &BenchRecording) -> Result<String, WriteError> {
        let believed = &recording.believed;
        Ok(format!(
            "# One joint on its bench, {} sessions. What is missing from this model?\n\
             recording = \"recording\"\n\n\
             [signals]\n\
             position = \"{measured}.position[0]\"     # rad\n\
             joint_torque = \"{measured}.effort[0]\"   # Nm\n\
             motor_torque = \"{}.effort[0]\"      # Nm\n\
             temperature = \"{}.temperature\" # degC\n\n\
             [model]\n\
             inertia = {:.6} # kg m2\n\
             gear_ratio = {}\n\
             effects = [{}]\n",
            recording.sessions.len(),
            topics::FOLLOWER_MOTOR_JS.name,
            temperature_topic()?.name,
            believed.inertia,
            believed.gear_ratio,
            quoted(&believed.effects),
            measured = topics::FOLLOWER_MEASURED_JS.name,
        ))
    }
}
