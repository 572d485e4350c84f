/** The address of the page's font: `font.js` makes it and its file. */
declare const __INTER__: string;
export const interUrl = () => __INTER__;

/** Text on a page and on a canvas. Until Inter is there, another takes the same room: `app.css`. */
export const FAMILY = 'Inter, "Inter at first", "Inter on Android", "Inter on Linux", system-ui, sans-serif';

let fetched: Promise<unknown> | undefined;

/** Fetches the font behind the first paint, once. Resolves when text is drawn in it, or where it cannot be had. */
export function inter(): Promise<unknown> {
  fetched ??= fetchInter();
  return fetched;
}

async function fetchInter(): Promise<void> {
  if (typeof FontFace === "undefined") return;
  await new Promise((painted) => requestAnimationFrame(() => setTimeout(painted)));
  const face = new FontFace("Inter", `url(${interUrl()})`, { weight: "400 600" });
  try {
    document.fonts.add(await face.load());
  } catch {
    // what stands in for it is legible too
  }
}
