/** Whether this browser can draw 3D at all. Asked once: a context costs memory until it is collected. */
export function hasWebGl(): boolean {
  known ??= tried();
  return known;
}

let known: boolean | undefined;

function tried(): boolean {
  try {
    const context = document.createElement("canvas").getContext("webgl2");
    context?.getExtension("WEBGL_lose_context")?.loseContext();
    return context !== null;
  } catch {
    return false;
  }
}
