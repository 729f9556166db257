// An animated GIF (version 89a) from pictures in RGBA: one palette for all, pixels that stay are left out, packed by LZW.
const animatedGif = (width, height) => {
  const STAYS = 255, BINS = 32768, CLEAR = 256, END = 257, MOST_CODES = 4096, LONGEST_BLOCK = 255;
  const out = [];
  const words = (...values) => values.forEach((value) => out.push(value & 255, value >> 8));
  const text = (letters) => out.push(...new TextEncoder().encode(letters));
  const bin = (rgba, at) => ((rgba[at] >> 3) << 10) | ((rgba[at + 1] >> 3) << 5) | (rgba[at + 2] >> 3);
  let palette = [], nearest = new Int16Array(BINS).fill(-1), before = null;

  // the 255 most frequent colours of some of the pictures, five bits a channel told apart, each the mean of its pixels
  function choose(samples) {
    const counts = new Uint32Array(BINS), sums = new Float64Array(3 * BINS);
    for (const rgba of samples) {
      for (let at = 0; at < rgba.length; at += 4) {
        const k = bin(rgba, at);
        counts[k] += 1;
        for (let channel = 0; channel < 3; channel += 1) sums[3 * k + channel] += rgba[at + channel];
      }
    }
    const found = [...counts.keys()].filter((k) => counts[k]).sort((a, b) => counts[b] - counts[a]).slice(0, STAYS);
    palette = found.map((k) => [0, 1, 2].map((channel) => Math.round(sums[3 * k + channel] / counts[k])));
    found.forEach((k, index) => { nearest[k] = index; });
    text("GIF89a");
    words(width, height);
    out.push(0xf7, 0, 0);
    for (let k = 0; k < 256; k += 1) out.push(...(palette[k] || [0, 0, 0]));
    out.push(0x21, 0xff, 11);
    text("NETSCAPE2.0");
    out.push(3, 1, 0, 0, 0);
  }
  function indexOf(rgba, at) {
    const k = bin(rgba, at);
    if (nearest[k] < 0) {
      let least = Infinity;
      palette.forEach(([red, green, blue], index) => {
        const apart = (rgba[at] - red) ** 2 + (rgba[at + 1] - green) ** 2 + (rgba[at + 2] - blue) ** 2;
        if (apart < least) { least = apart; nearest[k] = index; }
      });
    }
    return nearest[k];
  }
  function packed(indices) {
    const bytes = [], table = new Map();
    let held = 0, bits = 0, size = 9, next = END + 1;
    const emit = (code) => {
      held |= code << bits;
      bits += size;
      while (bits >= 8) { bytes.push(held & 255); held >>= 8; bits -= 8; }
    };
    emit(CLEAR);
    let prefix = indices[0];
    for (let k = 1; k < indices.length; k += 1) {
      const key = prefix * 256 + indices[k], known = table.get(key);
      if (known !== undefined) { prefix = known; continue; }
      emit(prefix);
      if (next === MOST_CODES) {
        emit(CLEAR);
        table.clear();
        [next, size] = [END + 1, 9];
      } else {
        if (next === 1 << size) size += 1;
        table.set(key, next++);
      }
      prefix = indices[k];
    }
    emit(prefix);
    emit(END);
    if (bits) bytes.push(held & 255);
    return bytes;
  }
  // one picture, shown for `delay` hundredths of a second
  function add(rgba, delay) {
    const indices = new Uint8Array(width * height), drawn = new Uint8Array(width * height);
    indices.forEach((_, k) => {
      indices[k] = indexOf(rgba, 4 * k);
      drawn[k] = before?.[k] === indices[k] ? STAYS : indices[k];
    });
    before = indices;
    out.push(0x21, 0xf9, 4, 0x05);
    words(delay);
    out.push(STAYS, 0, 0x2c, 0, 0, 0, 0);
    words(width, height);
    out.push(0, 8);
    const bytes = packed(drawn);
    for (let at = 0; at < bytes.length; at += LONGEST_BLOCK) out.push(Math.min(LONGEST_BLOCK, bytes.length - at), ...bytes.slice(at, at + LONGEST_BLOCK));
    out.push(0);
  }
  return { choose, add, bytes: () => new Uint8Array([...out, 0x3b]) };
};
