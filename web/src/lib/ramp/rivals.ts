/** How a ramp stands against a rival: the part of the rival's time that is saved. */
export function share(savedS: number, rivalS: number): number {
  return rivalS > 0 ? savedS / rivalS : 0;
}
