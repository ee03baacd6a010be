/* A host in C: streams samples, draws what changes, then a surface along a path. As in docs/embedding.md. */
#include <helibore/helibore.h>
#include <stdio.h>
#include <stdlib.h>

static void check(int32_t status) {
    if (status == HB_OK) return;
    printf("%d: %s\n", (int)status, hb_last_error());
    exit(1);
}

int main(void) {
    hb_settings settings;
    hb_path_settings path_settings;
    hb_change change;
    hb_wall_state state;
    const double station_depth[] = {0, 500, 1100}, inclination[] = {0, 10, 35}, azimuth[] = {40, 40, 55};
    double depth[1000], toolface[1000], radius[1000], *vertices;
    int64_t wall, path, vertex_count = 0, quad_count = 0, *quads;
    int packet, i;

    settings.size = sizeof settings;
    check(hb_settings_init(&settings));
    settings.bit_diameter = 0.216;
    settings.sectors = 32;
    settings.start_depth = 1000;
    check(hb_wall_create(&settings, &wall));

    for (packet = 0; packet < 5; ++packet) {
        for (i = 0; i < 1000; ++i) {
            depth[i] = 1000 + packet + i * 0.001;
            toolface[i] = i * 37 % 360;
            radius[i] = 0.11 + (packet == 2 ? 0.02 : 0);
        }
        change.size = sizeof change;
        check(hb_wall_append(wall, 1000, depth, toolface, radius, NULL, &change));
        printf("%d samples, %d changed ranges, settled to %d\n", (int)change.accepted, (int)change.ranges,
               (int)change.settled);
    }

    path_settings.size = sizeof path_settings;
    check(hb_path_settings_init(&path_settings));
    check(hb_path_create(&path_settings, 3, station_depth, inclination, azimuth, &path));
    state.size = sizeof state;
    check(hb_wall_get(wall, &state));
    if (hb_wall_surface(wall, path, 0, state.vertices, &vertex_count, NULL, NULL, &quad_count, NULL) !=
        HB_BUFFER_TOO_SMALL)
        return 1;
    vertices = malloc((size_t)vertex_count * 3 * sizeof *vertices);
    quads = malloc((size_t)quad_count * 4 * sizeof *quads);
    check(hb_wall_surface(wall, path, 0, state.vertices, &vertex_count, vertices, NULL, &quad_count, quads));
    printf("%d vertices, %d quads, first at %.6f %.6f %.6f\n", (int)vertex_count, (int)quad_count, vertices[0],
           vertices[1], vertices[2]);
    free(vertices);
    free(quads);

    toolface[17] = -1.0 / 0.0;
    if (hb_wall_append(wall, 1000, depth, toolface, radius, NULL, NULL) != HB_INPUT) return 1;
    printf("%s\n", hb_last_error());
    check(hb_close(path));
    check(hb_close(wall));
    return 0;
}
