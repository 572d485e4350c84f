import type { Plugin } from "vite";

export function inter(): Plugin;
