import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { api, type Schemas } from "../../api/client";

export type RegisterMap = Schemas["RegisterMapInfo"];
export type Finding = Schemas["MapFinding"];

const KEY = ["register-maps"];
/** Files are dropped into the server's folder too, by hand. */
const LOOK_EVERY_MS = 10_000;
/** What a larger file says nobody reads; the server refuses it too. */
const BYTES_MAX = 256 * 1024;

export function useRegisterMaps() {
  return useQuery({
    queryKey: KEY,
    queryFn: () => api.GET("/api/v1/register-maps"),
    refetchInterval: LOOK_EVERY_MS,
  });
}

/** Keeps the maps in some files, one after the other, and deletes one. What comes of it is in the catalog at once. */
export function useChangeMaps() {
  const queries = useQueryClient();
  const refresh = async () => {
    await queries.invalidateQueries({ queryKey: KEY });
    await queries.invalidateQueries({ queryKey: ["catalog"] });
    await queries.invalidateQueries({ queryKey: ["devices"] });
  };
  const keep = useMutation({
    mutationFn: async (file: File) => {
      if (file.size > BYTES_MAX) throw new Error(`${file.name} has ${file.size} bytes, a register map 256 KiB at most`);
      const format = /\.(csv|tsv)$/i.test(file.name) ? "csv" : "toml";
      const body = { text: await file.text(), format } as const;
      return await api.PUT("/api/v1/register-maps/{name}", { path: { name: nameOf(file) }, body });
    },
    onSettled: refresh,
  });
  const remove = useMutation({
    mutationFn: (name: string) => api.DELETE("/api/v1/register-maps/{name}", { path: { name } }),
    onSettled: refresh,
  });
  return { keep, remove };
}

export async function fetchMap(name: string): Promise<string> {
  return (await api.GET("/api/v1/register-maps/{name}", { path: { name } })).text;
}

/** What a file's map is called: its name without the ending, in the letters that a map may have. */
export function nameOf(file: Pick<File, "name">): string {
  const plain = file.name
    .replace(/\.[^.]*$/, "")
    .normalize("NFKD")
    .replace(/\p{M}/gu, "") // accents, which are signs of their own now
    .toLowerCase()
    .replace(/[^a-z0-9]+/g, "-")
    .replace(/^-+|-+$/g, "");
  return plain.slice(0, 40) || "map";
}
