// The force as sound, rumble and touch, for hands that hold a mouse.

let audio = null;
let tone = null;
let gain = null;

/** Sound on or off. Browsers want it to begin with a click. */
export function sound(on) {
  if (on && !audio) {
    audio = new AudioContext();
    tone = audio.createOscillator();
    gain = audio.createGain();
    tone.type = "triangle";
    gain.gain.value = 0;
    tone.connect(gain).connect(audio.destination);
    tone.start();
  }
  if (audio) on ? audio.resume() : audio.suspend();
}

let buzzed = 0;

/** Lets `newton` [N] on the hand, of `limit` [N] at most, be heard and felt. */
export function feel(newton, limit, rumble) {
  const share = Math.min(1, newton / limit);
  if (audio?.state === "running") {
    const now = audio.currentTime;
    gain.gain.setTargetAtTime(share < 0.01 ? 0 : 0.02 + 0.1 * share, now, 0.02);
    tone.frequency.setTargetAtTime(110 + 330 * share, now, 0.02);
  }
  const time = performance.now();
  if (!rumble || share < 0.02 || time - buzzed < 90) return;
  buzzed = time;
  for (const pad of navigator.getGamepads?.() || []) {
    pad?.vibrationActuator?.playEffect?.("dual-rumble", { duration: 100, strongMagnitude: share, weakMagnitude: share * 0.5 });
  }
  navigator.vibrate?.(Math.round(20 + 60 * share));
}
