export interface RegistersConfig {
  /** what is looked for: only what has it is listed */
  find: string;
}

export function readRegisters(raw: Readonly<Record<string, unknown>>): RegistersConfig {
  return { find: typeof raw.find === "string" ? raw.find.slice(0, 80) : "" };
}
