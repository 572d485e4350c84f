import { describe, expect, it } from "vitest";
import { type Kind, type Language, tokensOf } from "./highlight";

function piecesOf(text: string, language: Language): [Kind, string][] {
  return tokensOf(text, language)
    .filter(({ text: piece }) => piece.trim() !== "")
    .map(({ kind, text: piece }) => [kind, piece.trim()]);
}

describe("a program in colours", () => {
  it("tells remarks, words, texts and numbers of each language", () => {
    expect(piecesOf("return 'A', 12  # why", "python")).toEqual([
      ["word", "return"],
      ["text", "'A'"],
      ["plain", ","],
      ["number", "12"],
      ["remark", "# why"],
    ]);
    expect(piecesOf("{0x6Cu, 1}, /* a\nb */", "c")).toEqual([
      ["plain", "{"],
      ["number", "0x6Cu"],
      ["plain", ","],
      ["number", "1"],
      ["plain", "},"],
      ["remark", "/* a\nb */"],
    ]);
    expect(piecesOf("SAP 4, 0, 1000 // pps", "tmcl").at(0)).toEqual(["word", "SAP"]);
    expect(piecesOf("put 'V_MAX' # x", "curl")).toEqual([
      ["word", "put"],
      ["text", "'V_MAX'"],
      ["remark", "# x"],
    ]);
  });

  it("loses no letter, whatever the text is", () => {
    const odd = 'a "open\n /* never closed ## ${x#y} $# \' é 漢 0x12g 1.5.2 """ //';
    for (const language of ["python", "c", "curl", "tmcl"] as const)
      expect(
        tokensOf(odd, language)
          .map(({ text }) => text)
          .join(""),
      ).toBe(odd);
  });

  it("takes a dollar's hash for no remark", () => {
    expect(tokensOf("${a##*x} $#", "curl").every(({ kind }) => kind !== "remark")).toBe(true);
  });
});
