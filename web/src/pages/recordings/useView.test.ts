import { describe, expect, it } from "vitest";
import { textOf, windowOf } from "./useView";

describe("the stretch of a recording in the address", () => {
  it.each([null, [0, 1], [3.2, 4.9], [-1.5, 0.000001]] as const)("gives %j back", (window) => {
    expect(windowOf(textOf(window))).toEqual(window);
  });

  it.each(["", "~", "1", "2~1", "1~1", "a~b", "1~2~3", "NaN~2", "1~Infinity", "~2"])("makes nothing of %o", (text) => {
    expect(windowOf(text)).toBeNull();
  });
});
