package main

import (
	"bytes"
	"context"
	"encoding/binary"
	"fmt"
	"log"
	"os"
	"time"

	"google.golang.org/grpc"

	pb "example/latvoxv1"
)

func main() {
	connection, err := grpc.Dial(os.Args[1], grpc.WithInsecure())
	if err != nil {
		log.Fatal(err)
	}
	defer connection.Close()
	var mesh bytes.Buffer
	binary.Write(&mesh, binary.LittleEndian, []float32{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1})
	binary.Write(&mesh, binary.LittleEndian, []uint32{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3})
	spec := &pb.VoxelizeSpec{
		Lattice:  &pb.Lattice{Kind: &pb.Lattice_Named{Named: pb.NamedLattice_NAMED_LATTICE_BCC}},
		Sampling: &pb.VoxelizeSpec_Resolution{Resolution: 32},
		RawMesh:  &pb.RawMesh{Vertices: 4, Triangles: 4},
	}
	ctx, cancel := context.WithTimeout(context.Background(), time.Minute)
	defer cancel()
	answer, err := pb.NewVoxelizerClient(connection).VoxelizeSmall(ctx,
		&pb.VoxelizeSmallRequest{Spec: spec, Mesh: mesh.Bytes()})
	if err != nil {
		log.Fatal(err)
	}
	fmt.Printf("%d voxels, digest %s\n", answer.Summary.Voxels, answer.Summary.Certificate.Digest)
}
