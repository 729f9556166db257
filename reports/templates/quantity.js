// Numbers with units: at most three significant digits, as reports/tables/figures.py has them.
function quantity(value, unit) {
  if (value === null || value === undefined) return "–";
  if (!Number.isFinite(value)) return "NaN";
  const prefixes = { m: [[1e3, "km"], [1, "m"], [1e-3, "mm"], [1e-6, "µm"], [1e-9, "nm"]], us: [[1e6, "s"], [1e3, "ms"], [1, "µs"], [1e-3, "ns"]] }[unit];
  const short = (number) => Number(number.toPrecision(3)).toLocaleString("en", { maximumSignificantDigits: 3 });
  if (!prefixes) return `${Math.abs(value) < 1e-12 ? "0" : short(value)} ${unit === "deg" ? "°" : unit}`.trim();
  if (Math.abs(value) < (unit === "m" ? 1e-9 : 1e-3)) return "0";
  const [size, name] = prefixes.find(([least]) => Math.abs(value) >= 0.9995 * least) || prefixes.at(-1);
  return `${short(value / size)} ${name}`;
}
