// Figures as the words of these pages have them (reports/words/wording.py): three digits, and a unit of the right size.
"use strict";
const quantity = (() => {
  const PREFIXES = { m: [[1, "m"], [1e-3, "mm"], [1e-6, "µm"], [1e-9, "nm"]], us: [[1e6, "s"], [1e3, "ms"], [1, "µs"], [1e-3, "ns"]] };
  const small = (text) => text.replace(/(\.\d*?)0+$/, "$1").replace(/\.$/, "");
  const figures = (value) => {
    const size = Math.abs(value);
    if (size === 0) return "0";
    if (!(size >= 1e-3 && size < 1e6)) {
      const [digits, exponent] = value.toExponential(1).split("e");
      return `${digits}·10${[...String(Number(exponent))].map((sign) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(sign)]).join("")}`;
    }
    if (size >= 999.5) return Math.round(value).toLocaleString("en");
    const text = value.toPrecision(3);
    return Math.abs(Number(text)) < 1 ? small(text) : text;
  };
  // `round`: a chosen number, such as that of a tick, without the zeros that say how precisely something was measured
  return (value, unit, round = false) => {
    if (!Number.isFinite(value)) return "no number";
    const write = (number) => round && Math.abs(number) < 999.5 ? small(figures(number)) : figures(number);
    if (value === 0 && PREFIXES[unit]) return "0";
    if (unit === "m" && Math.abs(value) < 1e-9) return "< 1 nm";
    if (!PREFIXES[unit]) return `${write(value)} ${unit}`.trim();
    const [factor, name] = PREFIXES[unit].find(([size]) => Math.abs(value) >= 0.9995 * size) || PREFIXES[unit].at(-1);
    return `${write(value / factor)} ${name}`;
  };
})();
