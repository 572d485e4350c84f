import react from "@vitejs/plugin-react";
import postcss from "postcss";
import type { Plugin } from "vite";
import { defineConfig } from "vitest/config";
import { inter } from "./font.js";

// All that is needed of Node here; its type package would bring its globals into the browser code.
declare const process: { env: Record<string, string | undefined> };

// `make dev` sets STEPSCOPE_API to the server that it started; the UI is then served by Vite with hot reload.
const api = process.env.STEPSCOPE_API ?? "http://127.0.0.1:8000";

/** A first visit fetches two files, for one packs better than the dozens that pages share by two and three. */
const INITIAL: ["$initial"] = ["$initial"];
const FIRST = [
  { name: "base", test: /node_modules\//, tags: INITIAL },
  { name: "first", tags: INITIAL },
];

/** The component library's own class names, hashed: in the scripts of those components alone that are used. */
const LIBRARY_CLASS = /\bm_[0-9a-f]{6,8}\b/g;

/** Of its colours those that neither we nor its components use by themselves. */
const UNUSED_COLOUR = /^--mantine-color-(pink|grape|violet|indigo|cyan|lime)-/;

/** The sheet that is fetched behind the first page: `src/restStyles.ts`. */
const REST = /restStyles/;

/**
 * The library has one style sheet for all its components, most of which no page has. Rules for classes that no script
 * names are left out, and those that no script of a first visit names wait in a sheet of their own.
 */
function dealOutStyles(): Plugin {
  return {
    name: "deal-out-styles",
    apply: "build",
    enforce: "post",
    generateBundle(_, bundle) {
      const classesOf = (chunks: readonly string[]) =>
        new Set(
          chunks.flatMap((name) => {
            const file = bundle[name];
            return file?.type === "chunk" ? (file.code.match(LIBRARY_CLASS) ?? []) : [];
          }),
        );
      const first = new Set<string>();
      const follow = (name: string) => {
        const file = bundle[name];
        if (first.has(name) || file?.type !== "chunk") return;
        first.add(name);
        file.imports.forEach(follow);
      };
      for (const [name, file] of Object.entries(bundle)) if (file.type === "chunk" && file.isEntry) follow(name);
      const firstSheets = new Set(
        [...first].flatMap((name) => {
          const file = bundle[name];
          return file?.type === "chunk" ? [...(file.viteMetadata?.importedCss ?? [])] : [];
        }),
      );
      const usedFirst = classesOf([...first]);
      const used = classesOf(Object.keys(bundle));
      const all = (selector: string, classes: ReadonlySet<string>) =>
        (selector.match(LIBRARY_CLASS) ?? []).every((name) => classes.has(name));
      for (const file of Object.values(bundle)) {
        if (file.type !== "asset" || !file.fileName.endsWith(".css")) continue;
        const rest = REST.test(file.fileName);
        const isWanted = (selector: string) =>
          rest
            ? all(selector, used) && !all(selector, usedFirst)
            : all(selector, firstSheets.has(file.fileName) ? usedFirst : used);
        const sheet = postcss.parse(String(file.source));
        sheet.walkRules((rule) => {
          if (rule.parent?.type === "atrule" && /keyframes$/.test((rule.parent as postcss.AtRule).name)) return;
          const kept = rule.selectors.filter(isWanted);
          if (kept.length === 0) rule.remove();
          else if (kept.length < rule.selectors.length) rule.selectors = kept;
        });
        sheet.walkDecls(UNUSED_COLOUR, (declaration) => {
          declaration.remove();
        });
        sheet.walkAtRules((rule) => {
          if (rule.nodes?.length === 0) rule.remove();
        });
        file.source = sheet.toString();
      }
    },
  };
}

export default defineConfig({
  plugins: [react(), inter(), dealOutStyles()],
  build: {
    outDir: "dist",
    emptyOutDir: true,
    sourcemap: false,
    chunkSizeWarningLimit: 900,
    // The first script would name every other one, for those that a part needs to be asked for a round trip sooner.
    modulePreload: { resolveDependencies: (_, names, { hostType }) => (hostType === "html" ? names : []) },
    rolldownOptions: { output: { codeSplitting: { groups: FIRST } } },
  },
  // The server answers pages of its own host only: so Host stays what the page's Origin says.
  server: {
    proxy: { "/api": { target: api, ws: true, changeOrigin: false }, "/help": { target: api } },
    fs: { allow: [".", "../tests/telemetry"] }, // the frame that the tests of both sides read
  },
  // One page for all files, as in a browser: a page and all modules anew for each file was nine tenths of the work.
  test: {
    environment: "jsdom",
    isolate: false,
    pool: "threads",
    include: ["src/**/*.test.ts", "src/**/*.test.tsx"],
    css: { include: [/tokens\.css/] },
  },
});
