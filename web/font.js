import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";
import subset from "subset-font";

/** Latin with what European names need, and the signs of our own texts. */
const LATIN = [
  [0x20, 0x7e],
  [0xa0, 0x17f],
];
const SIGNS =
  "–—‘’“”„†•…‰‹›€™−≈≠≤≥√∞∑Ωαβγδεθλπρστφω" + "ΔΣΦ←↑→↓↔⌘✓✗▲▼◀▶●○¹²³⁴⁵⁶⁷⁸⁹⁰⁻₀₁₂₃½¼¾°′″╌━" + "\u2007\u2008\u2009\u202f";

function letters() {
  const codes = LATIN.flatMap(([from, to]) => Array.from({ length: to - from + 1 }, (_, index) => from + index));
  return String.fromCodePoint(...codes) + SIGNS;
}

/**
 * Inter (SIL Open Font License 1.1, inter-ui on npm) as the page needs it: weights 400 to 600 in the cut for small sizes,
 * figures of one width, a slashed zero. 350 kB become 34; the script knows the file's address as `__INTER__`.
 */
export function inter() {
  let file = { name: "", source: new Uint8Array() };
  return {
    name: "inter",
    async config() {
      const whole = readFileSync(new URL("node_modules/inter-ui/variable/InterVariable.woff2", import.meta.url));
      const source = await subset(whole, letters(), {
        targetFormat: "woff2",
        variationAxes: { wght: { min: 400, max: 600, default: 400 }, opsz: 14 },
        keepFeatures: ["kern", "ccmp", "locl", "mark", "tnum", "zero"],
      });
      const name = `assets/inter-${createHash("sha256").update(source).digest("hex").slice(0, 8)}.woff2`;
      file = { name, source };
      return { define: { __INTER__: JSON.stringify(`/${name}`) } };
    },
    configureServer(server) {
      server.middlewares.use(`/${file.name}`, (_request, response) => {
        response.setHeader("content-type", "font/woff2");
        response.end(file.source);
      });
    },
    generateBundle() {
      this.emitFile({ type: "asset", fileName: file.name, source: file.source });
      const licence = readFileSync(new URL("node_modules/inter-ui/LICENSE.txt", import.meta.url));
      this.emitFile({ type: "asset", fileName: "assets/inter-LICENSE.txt", source: licence });
    },
  };
}
