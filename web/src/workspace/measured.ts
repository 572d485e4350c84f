/** How large each part was when it was last drawn to be worked with: what is arranged begins with the same sizes. */
export const MEASURED = new Map<string, { width: number; height: number }>();

export function measure(): void {
  MEASURED.clear();
  for (const part of document.querySelectorAll<HTMLElement>("[data-part]")) {
    const { width, height } = part.getBoundingClientRect();
    MEASURED.set(part.dataset.part ?? "", { width, height });
  }
}
