/** Calls `beat` every five seconds, also while the page is in the background, until the answer is called. */
export function startBeat(beat: () => void): () => void {
  const worker = new Worker(new URL("./beat.worker.ts", import.meta.url), { type: "module" });
  worker.onmessage = beat;
  return () => worker.terminate();
}
