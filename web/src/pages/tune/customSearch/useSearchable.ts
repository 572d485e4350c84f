import { useQuery } from "@tanstack/react-query";
import { api } from "../../../api/client";
import type { FieldsProps } from "../kind";

/** Which settings of an axis may be searched, and what each takes, as it is set now. */
export function useSearchable({ device, index }: FieldsProps<never>["axis"]) {
  return useQuery({
    queryKey: ["searchable", device, index],
    queryFn: () => api.GET("/api/v1/studies/searchable/{device}/{axis}", { path: { device, axis: index } }),
    retry: false,
  });
}
