// Between the hand and the tip: from the leader's base frame to the follower's.

/** Where the arm brings its tip when the hand is there [m]. */
export function atTip(about, hand) {
  return about.workspace_offset.map((middle, axis) => middle + (hand[axis] || 0) * about.position_scale);
}

/** How far apart hand and tip are, where the tip is [m]; null where nobody's hand is there. */
export function apart(about, snapshot) {
  if (!snapshot.hand || !snapshot.tip) return null;
  return Math.hypot(...atTip(about, snapshot.hand).map((value, axis) => value - snapshot.tip[axis]));
}
