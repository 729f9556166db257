// Joints of tracked hands (WebXR Hand Input, names of XRHandJoint) as goals of links: axes, alignment, and which joint leads which link.
// Quaternions are (w, x, y, z), positions metres, both in the scene's axes (z up) once they have passed `fromXr`.

// A link's frame sits in its joint's centre, which for a last bone is the joint between the last two bones.
export const LEADING = {
  "wrist": ["wrist", "palm", "hand"], "thumb-phalanx-distal": ["thumb"], "index-finger-phalanx-distal": ["index"],
  "middle-finger-phalanx-distal": ["middle"], "ring-finger-phalanx-distal": ["ring"], "pinky-finger-phalanx-distal": ["little", "pinky"],
};
export const JOINTS = Object.keys(LEADING);
export const SIDES = ["left", "right"];
const FINGERS = ["thumb", "index", "middle", "ring", "little", "pinky"];

export const multiply = ([a, b, c, d], [e, f, g, h]) =>
  [a * e - b * f - c * g - d * h, a * f + b * e + c * h - d * g, a * g - b * h + c * e + d * f, a * h + b * g - c * f + d * e];
export const conjugate = ([w, x, y, z]) => [w, -x, -y, -z];
export const rotate = (q, v) => multiply(multiply(q, [0, ...v]), conjugate(q)).slice(1);
export const about = (radians) => [Math.cos(radians / 2), 0, 0, Math.sin(radians / 2)];

// WebXR has x right, y up, -z forward; the scene x forward, y left, z up (docs/units_and_frames.md)
export const fromXr = (position, orientation) => ({
  position: [-position.z, -position.x, position.y],
  rotation: [orientation.w, -orientation.z, -orientation.x, orientation.y],
});

// Which link each joint of a hand leads, by names: {left: {wrist: "avatar/left_wrist", ...}, right: {...}}; "" where nothing fits.
export function guess(links) {
  const found = {};
  const sided = (name) => (/left|(^|[\/_])l_/.test(name) ? "left" : /right|(^|[\/_])r_/.test(name) ? "right" : "");
  for (const side of SIDES) {
    found[side] = {};
    // hands without a side are the right one
    const its = links.filter((link) => (sided(link.toLowerCase()) || "right") === side);
    for (const joint of JOINTS) {
      // an avatar's own name says nothing of a link, unless it has no other
      const fits = its.filter((link) => {
        const name = link.slice(link.indexOf("/") + 1).toLowerCase();
        return LEADING[joint].some((word) => name.includes(word)) && !(joint === "wrist" && FINGERS.some((word) => name.includes(word)));
      });
      found[side][joint] = (joint === "wrist" ? fits[0] : fits.at(-1)) ?? "";
    }
  }
  return found;
}

// Where tracked space lies in the scene: set by a joint that leads a link and by where that link is shown.
export class Alignment {
  constructor(yaw = 0) {
    this.yaw = about(yaw);
    this.shift = null;
    this.first = {};
  }

  pose(xr) {
    const place = rotate(this.yaw, xr.position);
    const turned = multiply(multiply(this.yaw, xr.rotation), conjugate(this.yaw));
    return { position: place.map((value, k) => value + (this.shift?.[k] ?? 0)), rotation: turned };
  }

  // The goal of a link; it turns as the joint has turned since it was seen first, from how the link was shown then.
  goal(link, xr, shown, isTurned) {
    if (this.shift === null) {
      const there = this.pose(xr).position;
      this.shift = shown.position.map((value, k) => value - there[k]);
    }
    const now = this.pose(xr);
    if (!isTurned) return { position: now.position };
    this.first[link] ??= { rotation: now.rotation, shown: shown.orientation };
    const since = multiply(now.rotation, conjugate(this.first[link].rotation));
    const turned = multiply(since, this.first[link].shown);
    const length = Math.hypot(...turned);
    return { position: now.position, rotation: turned.map((value) => value / length) };
  }
}

// The message for one frame: `seen` has a pose for each joint of each hand that is tracked, `leads` links by side and joint.
export function message(seen, leads, shown, alignment, isTurned) {
  const links = {};
  for (const side of SIDES) {
    // the wrist first, since it says where tracked space lies
    for (const joint of JOINTS) {
      const link = leads[side][joint], xr = seen[side]?.[joint];
      if (link && xr && shown[link]) links[link] = alignment.goal(link, xr, shown[link], isTurned && joint === "wrist");
    }
  }
  return { links };
}
