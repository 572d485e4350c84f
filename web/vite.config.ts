import react from "@vitejs/plugin-react";
import { defineConfig } from "vitest/config";

// All that is needed of Node here; its type package would bring its globals into the browser code.
declare const process: { env: Record<string, string | undefined> };

// `make dev` sets STEPSCOPE_API to the server that it started; the UI is then served by Vite with hot reload.
const api = process.env.STEPSCOPE_API ?? "http://127.0.0.1:8000";

export default defineConfig({
  plugins: [react()],
  build: { outDir: "dist", emptyOutDir: true, sourcemap: false, chunkSizeWarningLimit: 900 },
  // The server answers pages of its own host only: so Host stays what the page's Origin says.
  server: {
    proxy: {
      "/api": { target: api, ws: true, changeOrigin: false },
      "/twin/view": { target: api, ws: true, changeOrigin: false },
    },
    fs: { allow: [".", "../tests/telemetry"] }, // the frame that the tests of both sides read
  },
  test: { environment: "jsdom", include: ["src/**/*.test.ts", "src/**/*.test.tsx"] },
});
